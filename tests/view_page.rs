//! Pages in a browser: of a part (a real click on a face, on an edge, a body hidden by the tree), of a run, of a difference.
//!
//! Needs `chromium` and `chromedriver`; without them the test passes over it, unless
//! `RESURF_REQUIRE_VALIDATORS=1`.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use resurf::brep::FaceId;
use resurf::math::Point3;
use resurf::model::{Instances, Model};
use resurf::source::Source;
use resurf::step::{ExchangeStructure, to_model};
use resurf::units::LengthUnit;
use serde_json::{Value, json};

/// A browser that is driven by WebDriver (W3C): one session, ended when dropped.
struct Browser {
    driver: Child,
    port: u16,
    session: String,
}

impl Browser {
    fn start() -> Option<Self> {
        let required = std::env::var_os("RESURF_REQUIRE_VALIDATORS").is_some_and(|value| value == "1");
        let mut driver = match Command::new("chromedriver")
            .arg("--port=0")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
        {
            Ok(driver) => driver,
            Err(error) => {
                assert!(!required, "chromedriver: {error}");
                return None;
            }
        };
        let mut lines = BufReader::new(driver.stdout.take().expect("piped")).lines();
        let port = lines.find_map(|line| {
            let line = line.ok()?;
            let (_, port) = line.split_once("started successfully on port ")?;
            port.trim_end_matches('.').parse().ok()
        });
        // What it says later must have somewhere to go.
        std::thread::spawn(move || lines.for_each(drop));
        let mut browser =
            Self { driver, port: port.expect("chromedriver says its port"), session: String::new() };
        let arguments = [
            "--headless",
            "--no-sandbox",
            "--window-size=1000,700",
            "--use-gl=angle",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
        ];
        let options = json!({ "goog:chromeOptions": { "args": arguments } });
        let answer = browser.ask("POST", "/session", &json!({ "capabilities": { "alwaysMatch": options } }));
        let session = answer["sessionId"].as_str();
        assert!(session.is_some() || !required, "no browser: {answer}");
        browser.session = format!("/session/{}", session?);
        Some(browser)
    }

    fn ask(&self, method: &str, path: &str, body: &Value) -> Value {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("chromedriver listens");
        let body = if method == "POST" { body.to_string() } else { String::new() };
        write!(
            stream,
            "{method} {path} HTTP/1.1\r\nHost: localhost:{}\r\nContent-Type: application/json\r\n\
             Content-Length: {}\r\nConnection: close\r\n\r\n{body}",
            self.port,
            body.len()
        )
        .expect("chromedriver listens");
        let mut answer = String::new();
        // The driver keeps the connection open: the length says where the answer ends.
        let mut reader = BufReader::new(stream);
        let mut length = 0;
        loop {
            let mut line = String::new();
            reader.read_line(&mut line).expect("an answer");
            if let Some(number) = line.to_ascii_lowercase().strip_prefix("content-length:") {
                length = number.trim().parse().expect("a length");
            }
            if line.trim().is_empty() {
                break;
            }
        }
        reader.take(length).read_to_string(&mut answer).expect("an answer");
        let answer: Value = serde_json::from_str(&answer).expect("JSON");
        answer["value"].clone()
    }

    fn command(&self, path: &str, body: &Value) -> Value {
        let answer = self.ask("POST", &format!("{}{path}", self.session), body);
        assert!(answer["error"].is_null(), "{path}: {answer}");
        answer
    }

    fn script(&self, script: &str) -> Value {
        self.command("/execute/sync", &json!({ "script": script, "args": [] }))
    }

    /// Presses and releases the left button at a place of the window.
    fn click(&self, x: f64, y: f64) {
        let to = json!({ "type": "pointerMove", "duration": 0, "x": x.round(), "y": y.round(), "origin": "viewport" });
        let (down, up) =
            (json!({ "type": "pointerDown", "button": 0 }), json!({ "type": "pointerUp", "button": 0 }));
        let mouse = json!({ "type": "pointer", "id": "mouse", "actions": [to, down, up] });
        self.command("/actions", &json!({ "actions": [mouse] }));
    }

    /// Clicks in the middle of the first element of a tag that holds a text.
    fn click_on(&self, tag: &str, text: &str) {
        let place = self.script(&format!(
            "const found = [...document.querySelectorAll('{tag}')].find(e => e.textContent.trim() === '{text}');\
             const box = found.getBoundingClientRect(); return [box.left + 8, box.top + box.height / 2];"
        ));
        self.click(place[0].as_f64().expect("x"), place[1].as_f64().expect("y"));
    }

    fn picked(&self) -> String {
        self.script("return document.getElementById('picked').textContent;")
            .as_str()
            .expect("a text")
            .to_owned()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !self.session.is_empty() {
            self.ask("DELETE", &self.session, &Value::Null);
        }
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}

fn read(path: &Path) -> Model {
    let source = Source::new(std::fs::read(path).expect("a sample")).expect("small");
    let mut sink = Vec::new();
    let file = ExchangeStructure::parse(source, &mut sink);
    to_model(&file, &mut sink)
}

/// Corners of a face.
fn corners(model: &Model, face: FaceId) -> Vec<Point3<f64>> {
    let brep = &model.brep;
    let edges = brep.coedges_of(face).map(|coedge| &brep.edges[brep.coedges[coedge].edge]);
    edges.flat_map(|edge| [edge.start, edge.end]).map(|vertex| brep.vertices[vertex].point).collect()
}

#[test]
fn a_click_reads_the_face_or_the_edge_below_it() {
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/assembly/assembly.step");
    let folder = tempfile::tempdir().expect("a folder");
    let page = folder.path().join("part.html");
    let program =
        Command::new(env!("CARGO_BIN_EXE_resurf")).arg("view").arg(&sample).arg("-o").arg(&page).output();
    let output = program.expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let html = std::fs::read_to_string(&page).expect("a page");
    assert!(!html.contains("http://") && !html.contains("https://"), "the page fetches nothing");

    let Some(browser) = Browser::start() else { return };
    browser.command("/url", &json!({ "url": format!("file://{}", page.display()) }));

    // The bracket alone, from above: its highest face fills the middle.
    let model = read(&sample);
    let instances = Instances::of(&model, &LengthUnit::millimetre(), 10);
    let bracket = instances.bodies.iter().find(|placed| {
        placed.node.is_some_and(|node| model.products[instances.nodes[node].product].name == "bracket")
    });
    let placed = bracket.expect("the sample has a bracket");
    let body = placed.body;
    let faces: Vec<FaceId> = model.brep.faces.ids().filter(|&face| model.body_of(face) == body).collect();
    let height = |face: &FaceId| corners(&model, *face).iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let top = *faces.iter().max_by(|a, b| height(a).total_cmp(&height(b))).expect("faces");
    browser.click_on("label", "door");
    browser.click_on("button", "Top");
    let canvas = browser.script(
        "const b = document.getElementById('canvas').getBoundingClientRect(); return [b.left, b.top, b.width, b.height];",
    );
    let [left, upper, width, tall] = [0, 1, 2, 3].map(|k| canvas[k].as_f64().expect("a number"));
    let middle = [left + width / 2.0, upper + tall / 2.0];
    browser.click(middle[0], middle[1]);
    let said = browser.picked();
    for word in [&model.origins.faces[top].to_string(), "plane", "#9999a6", "door-assembly / bracket", "mm²"]
    {
        assert!(said.contains(word), "no {word} in {said}");
    }
    let selector = browser.script("return document.getElementById('selector').textContent;");
    assert_eq!(selector, format!("\"{}\"", model.origins.faces[top]));

    // The page fits the box with a margin of 8 %: the side of the box lies there.
    let points: Vec<Point3<f64>> = corners(&model, top).iter().map(|p| placed.transform.point(p)).collect();
    let side = |k: usize| {
        let parts = points.iter().map(|p| p[k]);
        parts.clone().fold(f64::NEG_INFINITY, f64::max) - parts.fold(f64::INFINITY, f64::min)
    };
    let half = 1.08 * (side(1) / 2.0).max(side(0) / 2.0 / (width / tall));
    browser.click(middle[0] + side(0) / 2.0 / half * tall / 2.0, middle[1]);
    let said = browser.picked();
    assert!(said.starts_with("Edge#") && said.contains("line"), "{said}");

    browser.click_on("label", "bracket");
    browser.click(middle[0], middle[1]);
    assert_eq!(browser.picked(), "Click a face or an edge.");
}

/// Runs the program in a folder and holds that it ends with a code.
fn run(folder: &Path, arguments: &[&str], code: i32) {
    let program = Command::new(env!("CARGO_BIN_EXE_resurf")).args(arguments).current_dir(folder).output();
    let output = program.expect("the program runs");
    assert_eq!(output.status.code(), Some(code), "{}", String::from_utf8_lossy(&output.stderr));
}

/// A folder with the door, half of the door, and a job that scales them.
fn a_night() -> tempfile::TempDir {
    let door = std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/door/door.step"))
        .expect("a sample");
    let job = "version = 1\nname = \"a <b> night\"\ninputs = [\"*.step\"]\noutput = \"out/{stem}.{ext}\"\n\
        [[operation]]\nkind = \"constrained_scale\"\nfactors = [1.1, 1.2, 1.25]\n";
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("job.toml"), job).expect("written");
    std::fs::write(folder.path().join("door.step"), &door).expect("written");
    std::fs::write(folder.path().join("half.step"), &door[..door.len() / 2]).expect("written");
    folder
}

#[test]
fn the_page_of_a_run_shows_what_failed_and_what_changed() {
    let folder = a_night();
    run(folder.path(), &["run", "job.toml", "--html", "night.html"], 1);
    let page = folder.path().join("night.html");
    let html = std::fs::read_to_string(&page).expect("a page");
    assert!(!html.contains("http://") && !html.contains("https://"), "the page fetches nothing");
    assert!(html.contains("a &lt;b&gt; night") && !html.contains("a <b> night"));
    // A second run draws nothing again and leaves the same pictures.
    run(folder.path(), &["run", "job.toml", "--html", "night.html"], 1);
    let pictures = |html: &str| {
        html.split("base64,").skip(1).map(|rest| rest.split('"').next().map(str::len)).collect::<Vec<_>>()
    };
    assert_eq!(pictures(&html), pictures(&std::fs::read_to_string(&page).expect("a page")));

    let Some(browser) = Browser::start() else { return };
    browser.command("/url", &json!({ "url": format!("file://{}", page.display()) }));
    let text = |script: &str| browser.script(script).as_str().unwrap_or_default().to_owned();
    let summary = text("return document.querySelector('p').textContent;");
    assert!(summary.starts_with("2 parts: 1 done, 1 failed, 2 unchanged"), "{summary}");
    // What failed is open, with its reason; the other opens by a click, with pictures that are some.
    let open = text(
        "return [...document.querySelectorAll('tbody.open td:first-child')].map(e => e.textContent).join();",
    );
    assert!(open.starts_with("half.step"), "{open}");
    let why = text("return document.querySelector('tbody.open .why').textContent;");
    assert!(why.contains("the file ends inside a record"), "{why}");
    browser.click_on("td", "door.step");
    let widths = browser.script(
        "return [...document.querySelectorAll('tbody.done img')].map(e => e.offsetWidth && e.naturalWidth);",
    );
    assert_eq!(widths, json!([840, 420]));
    let link = text("return document.querySelector('tbody.done a').href;");
    browser.click_on("button", "failed (1)");
    assert_eq!(
        text(
            "return [...document.querySelectorAll('tbody')].filter(e => e.offsetHeight > 0).map(e => e.className).join();"
        ),
        "failed open"
    );
    browser.command("/url", &json!({ "url": link }));
    assert!(text("return document.getElementById('legend').textContent;").contains("1 changed"));
}

#[test]
fn the_page_of_a_difference_is_red_where_it_is_greatest() {
    let folder = a_night();
    run(folder.path(), &["run", "job.toml"], 1);
    run(folder.path(), &["diff", "door.step", "out/door.step", "--html", "d.html"], 1);
    let Some(browser) = Browser::start() else { return };
    browser.command("/url", &json!({ "url": format!("file://{}", folder.path().join("d.html").display()) }));
    browser.click_on("button", "Top");
    // Share of the coloured pixels that are reddish, in the left and in the right third of the window.
    let reds = "const c = document.getElementById('canvas'), g = document.createElement('canvas').getContext('2d');\
        g.canvas.width = c.width; g.canvas.height = c.height; g.drawImage(c, 0, 0);\
        const red = (from, to) => { let n = 0; const d = g.getImageData(from, 0, to - from, c.height).data;\
        for (let k = 0; k < d.length; k += 4) if (d[k] > 90 && d[k] > 2 * d[k + 1] && d[k] > 2 * d[k + 2]) n++; return n; };\
        const w = Math.floor(c.width / 3); return [red(0, w), red(c.width - w, c.width)];";
    browser.script("draw();");
    let counts = browser.script(reds);
    let [left, right] = [0, 1].map(|k| counts[k].as_u64().expect("a count"));
    // Scaled about the origin, the door's far end moved most.
    assert!(right > 200 && right > 2 * left, "{counts}");
    browser.click_on("button", "Colours");
    browser.script("draw();");
    // Its own colour is red all over.
    let own = browser.script(reds);
    assert!(own[0].as_u64() > Some(10 * left), "{own}");
}
