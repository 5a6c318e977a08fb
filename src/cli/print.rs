//! Where words go: data to standard output, messages to standard error.

use std::io::{ErrorKind, IsTerminal, Write};
use std::ops::Range;

use annotate_snippets::renderer::{AnsiColor, Style};
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

use super::exit_code;
use crate::diagnostic::Severity;

/// Prints, and remembers what went wrong with printing.
#[derive(Debug)]
pub struct Printer {
    renderer: Renderer,
    code: Option<u8>,
}

/// A file with the place that a message is about.
#[derive(Debug, Clone)]
pub struct Place<'a> {
    /// Name as the user knows it.
    pub path: &'a str,
    /// All bytes.
    pub bytes: &'a [u8],
    /// What the message is about.
    pub span: Range<usize>,
}

/// Bytes shown before and after a place: some files are one line of megabytes.
const WINDOW: usize = 120;

impl Printer {
    /// A printer for the process's streams; colours on a terminal, unless `NO_COLOR` is set.
    #[must_use]
    pub fn new() -> Self {
        let plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        let coloured = std::io::stderr().is_terminal() && !plain;
        let renderer = if coloured {
            Renderer::styled().line_num(Style::new().fg_color(Some(AnsiColor::BrightBlue.into())))
        } else {
            Renderer::plain()
        };
        Self { renderer, code: None }
    }

    /// The exit code that printing asks for, if it went wrong.
    #[must_use]
    pub fn code(&self) -> Option<u8> {
        self.code
    }

    /// Data for standard output, as it is.
    pub fn data(&mut self, text: &str) {
        let mut out = std::io::stdout().lock();
        let result = out.write_all(text.as_bytes()).and_then(|()| out.flush());
        self.note(result);
    }

    /// A line for standard error.
    pub fn line(&mut self, text: &str) {
        let result = writeln!(std::io::stderr().lock(), "{text}");
        self.note(result);
    }

    /// A message without a place.
    pub fn message(&mut self, severity: Severity, text: &str) {
        let text = self.renderer.render(&[Group::with_title(level(severity).primary_title(text))]);
        self.line(&text);
    }

    /// A message with its place: path, line and column, and the text around it.
    pub fn placed(&mut self, severity: Severity, code: &str, text: &str, place: &Place<'_>) {
        let window = Window::around(place);
        let title = level(severity).primary_title(text);
        let title = if code.is_empty() { title } else { title.id(code) };
        let snippet = Snippet::source(&window.text)
            .path(place.path)
            .line_start(window.line)
            .annotation(AnnotationKind::Primary.span(window.span));
        let text = self.renderer.render(&[Group::with_title(title).element(snippet)]);
        self.line(&text);
    }

    fn note(&mut self, result: std::io::Result<()>) {
        match result {
            Ok(()) => {}
            // The reader has gone, and it got what it wanted.
            Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                self.code.get_or_insert(exit_code::DONE);
            }
            Err(_) => self.code = Some(exit_code::IO),
        }
    }
}

impl Default for Printer {
    fn default() -> Self {
        Self::new()
    }
}

fn level(severity: Severity) -> Level<'static> {
    match severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    }
}

/// The lines around a place, cut to the window, as text that a terminal can show.
struct Window {
    text: String,
    line: usize,
    span: Range<usize>,
}

impl Window {
    fn around(place: &Place<'_>) -> Self {
        let length = place.bytes.len();
        let at = place.span.start.min(length);
        let end = place.span.end.clamp(at, length).min(at + WINDOW);
        let is_end = |b: u8| b == b'\n' || b == b'\r';
        let low = at.saturating_sub(WINDOW);
        let start = (low..at).rev().find(|&i| is_end(place.bytes[i])).map_or(low, |i| i + 1);
        let high = (end + WINDOW).min(length);
        let stop = (end..high).find(|&i| is_end(place.bytes[i])).unwrap_or(high);
        let shown = |range: Range<usize>| clean(&place.bytes[range]);
        let (before, marked, after) = (shown(start..at), shown(at..end), shown(end..stop));
        let span = before.len()..before.len() + marked.len();
        Self { text: before + &marked + &after, line: line(&place.bytes[..at]), span }
    }
}

/// Bytes as text without control characters, line ends apart.
fn clean(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes).replace("\r\n", "\n").replace('\r', "\n");
    text.chars().map(|c| if c.is_control() && c != '\n' && c != '\t' { '\u{fffd}' } else { c }).collect()
}

/// Number of the line behind some bytes.
fn line(before: &[u8]) -> usize {
    let mut count = 1;
    for at in memchr::memchr2_iter(b'\n', b'\r', before) {
        let of_crlf = before[at] == b'\r' && before.get(at + 1) == Some(&b'\n');
        count += usize::from(!of_crlf);
    }
    count
}
