//! Asks other programs about a written file, and meshes what they need.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::brep::{BodyId, BodyKind, FaceId};
use crate::job::failure::PartError;
use crate::job::file::{SideFormat, ValidateSettings, ValidatorName};
use crate::job::output::FileError;
use crate::mesh::{Mesh, Part, Scene, Tolerances, glb, off, stl, tessellate_bodies, three_mf};
use crate::model::{Colour, Instances, Model};
use crate::units::{Length, LengthUnit};
use crate::validate::{Request, ValidateError, Validator, Verdict, ask_freecad, ask_openscad};

impl From<ValidatorName> for Validator {
    fn from(name: ValidatorName) -> Self {
        match name {
            ValidatorName::FreeCad => Self::FreeCad,
            ValidatorName::OpenScad => Self::OpenScad,
        }
    }
}

/// The first required program that is not there: known before any data is touched.
#[must_use]
pub fn first_missing(settings: &ValidateSettings) -> Option<ValidateError> {
    let wanted = settings.with.iter().map(|&name| Validator::from(name)).filter(|_| settings.require);
    wanted.filter(|v| find(&v.program()).is_none()).map(missing).next()
}

fn missing(validator: Validator) -> ValidateError {
    ValidateError::Missing {
        program: validator.program().to_string_lossy().into_owned(),
        install: validator.install_command(),
        variable: validator.program_variable(),
    }
}

/// Where the program of a validator is.
#[must_use]
pub fn program_of(name: ValidatorName) -> Option<PathBuf> {
    find(&Validator::from(name).program())
}

/// Where a program is, by its path or in `PATH`.
fn find(program: &OsStr) -> Option<PathBuf> {
    let named = Path::new(program);
    if named.components().count() > 1 {
        return named.is_file().then(|| named.to_owned());
    }
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).map(|folder| folder.join(named)).find(|place| place.is_file())
}

/// What the programs said.
#[derive(Debug, Default)]
pub struct Judged {
    /// Verdicts in the job's order.
    pub verdicts: Vec<Verdict>,
    /// Programs that could not be asked, and why; none of them was required.
    pub unasked: Vec<String>,
}

/// Asks all programs of a job about one written file.
///
/// # Errors
/// [`PartError::Refused`], and [`PartError::NoVerdict`] when a program fails or a required one is missing.
pub fn judge(
    settings: &ValidateSettings,
    written: &Path,
    model: &Model,
    chord: Option<f64>,
) -> Result<Judged, PartError> {
    let mut judged = Judged::default();
    let timeout = settings.timeout.map_or(Request::DEFAULT_TIMEOUT, |s| Duration::from_secs_f64(s.0));
    for &name in &settings.with {
        let scratch = tempfile::tempdir().map_err(|source| io(Path::new("temporary folder"), source))?;
        let asked = match name {
            ValidatorName::FreeCad => ask_freecad(&request(written, scratch.path(), timeout)),
            ValidatorName::OpenScad => match coarse_mesh(model, scratch.path(), chord)? {
                Some(mesh) => ask_openscad(&request(&mesh, scratch.path(), timeout)),
                None => {
                    judged.unasked.push("OpenSCAD takes closed meshes, and the part has no solid".to_owned());
                    continue;
                }
            },
        };
        match asked {
            Ok(verdict) => judged.verdicts.push(verdict),
            Err(error @ ValidateError::Missing { .. }) if !settings.require => {
                judged.unasked.push(error.to_string());
            }
            Err(error) => return Err(error.into()),
        }
    }
    Ok(judged)
}

/// The first refusal among some verdicts.
///
/// # Errors
/// [`PartError::Refused`].
pub fn refuse(verdicts: &[Verdict]) -> Result<(), PartError> {
    match verdicts.iter().find(|verdict| !verdict.accepted) {
        Some(verdict) => Err(PartError::Refused {
            program: verdict.validator.as_str(),
            messages: verdict.messages.clone(),
        }),
        None => Ok(()),
    }
}

/// Where FreeCAD counts other faces than we do. Assemblies are left out: it counts each use of a part.
pub fn other_counts(verdicts: &[Verdict], model: &Model) -> impl Iterator<Item = String> {
    let ours = model.brep.faces.len() as u64;
    let single = model.occurrences.is_empty();
    let counted = verdicts.iter().filter(move |v| single && v.validator == Validator::FreeCad);
    let other = counted.filter_map(|v| v.figures.faces).filter(move |&faces| faces != ours);
    other.map(move |faces| format!("FreeCAD counts {faces} faces where the file has {ours}"))
}

fn request<'a>(file: &'a Path, scratch: &'a Path, timeout: Duration) -> Request<'a> {
    Request { file, scratch, timeout, program: None }
}

fn io(path: &Path, source: std::io::Error) -> PartError {
    PartError::Output(FileError { path: path.to_owned(), source })
}

/// The closed mesh of the solids of a part, written for OpenSCAD; `None` without solids.
fn coarse_mesh(model: &Model, scratch: &Path, chord: Option<f64>) -> Result<Option<PathBuf>, PartError> {
    let Some(mesh) = solid_mesh(model, chord)? else { return Ok(None) };
    let path = scratch.join("part.off");
    let bytes = mesh_bytes(&mesh, SideFormat::Off);
    std::fs::write(&path, bytes).map_err(|source| io(&path, source))?;
    Ok(Some(path))
}

/// Triangles of all solids, each where the assembly has it; `None` without solids.
///
/// # Errors
/// [`PartError::Mesh`] naming the face.
fn solid_mesh(model: &Model, chord: Option<f64>) -> Result<Option<Mesh>, PartError> {
    let mesh = placed_mesh(model, chord, |body| model.brep.bodies[body].kind == BodyKind::Solid)?;
    Ok(Some(mesh).filter(|mesh| !mesh.triangles.is_empty()))
}

/// The bytes of a mesh file of all bodies.
///
/// # Errors
/// [`PartError::Mesh`] naming the face.
pub fn side_bytes(model: &Model, chord: Option<f64>, format: SideFormat) -> Result<Vec<u8>, PartError> {
    let mut bytes = Vec::new();
    let written = match format {
        SideFormat::Stl | SideFormat::StlText | SideFormat::Off => {
            return Ok(mesh_bytes(&placed_mesh(model, chord, |_| true)?, format));
        }
        SideFormat::ThreeMf => three_mf::write(&scene(model, chord)?, &mut bytes),
        SideFormat::Glb => glb::write(&scene(model, chord)?, &mut bytes),
    };
    let too_large = |error: std::io::Error| PartError::Mesh(error.to_string());
    written.map(|()| bytes).map_err(too_large)
}

/// All bodies, each where the assembly has it, as meshes with their names and colours, in the unit of the first
/// context. Colours that hold in one use only are passed over.
///
/// # Errors
/// [`PartError::Mesh`] naming the face.
fn scene(model: &Model, chord: Option<f64>) -> Result<Scene, PartError> {
    let rgb = |colour: Colour| [colour.red, colour.green, colour.blue];
    let mut parts = Vec::new();
    each_placed(
        model,
        chord,
        |_| true,
        |body, mesh| {
            let attributes = &model.bodies[body];
            let product = attributes.product.map(|at| &model.products[at]);
            let own = Some(attributes.own.name.clone()).filter(|name| !name.is_empty());
            let shells = &model.brep.bodies[body].shells;
            let faces = shells.iter().flat_map(|&shell| &model.brep.shells[shell].faces);
            let colour = |face: FaceId| model.faces[face].appearance.colour;
            let of_product = product.and_then(|product| product.appearance.colour);
            parts.push(Part {
                name: own.or(product.map(|product| product.name.clone())).unwrap_or_default(),
                mesh,
                colour: attributes.own.appearance.colour.or(of_product).map(rgb),
                faces: faces.filter_map(|&face| Some((face, rgb(colour(face)?)))).collect(),
            });
        },
    )?;
    Ok(Scene { metres: common_unit(model).metres, parts })
}

/// Triangles of the bodies that are wanted, each where the assembly has it, in the unit of the first context.
fn placed_mesh(
    model: &Model,
    chord: Option<f64>,
    wanted: impl Fn(BodyId) -> bool,
) -> Result<Mesh, PartError> {
    let mut whole = Mesh::default();
    each_placed(model, chord, wanted, |_, mesh| whole.append(&mesh))?;
    Ok(whole)
}

/// Shows the mesh of every instance of the bodies that are wanted; each body is meshed once.
fn each_placed(
    model: &Model,
    chord: Option<f64>,
    wanted: impl Fn(BodyId) -> bool,
    mut show: impl FnMut(BodyId, Mesh),
) -> Result<(), PartError> {
    let mut meshes: BTreeMap<BodyId, Mesh> = BTreeMap::new();
    let instances = Instances::of(model, &common_unit(model), Instances::LIMIT);
    for placed in instances.bodies.iter().filter(|placed| wanted(placed.body)) {
        let mesh = match meshes.entry(placed.body) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(place) => place.insert(mesh_of(model, placed.body, chord)?),
        };
        show(placed.body, mesh.transformed(&placed.transform));
    }
    Ok(())
}

/// The unit in which bodies of different contexts are put together: that of the first.
fn common_unit(model: &Model) -> LengthUnit {
    model.contexts.first().map_or_else(LengthUnit::millimetre, |context| context.length.clone())
}

fn mesh_of(model: &Model, body: BodyId, chord: Option<f64>) -> Result<Mesh, PartError> {
    let mut tolerances = Tolerances::for_size(diagonal(model));
    if let Some(chord) = chord {
        tolerances.chord = chord;
    }
    tessellate_bodies(&model.brep, &[body], &tolerances).map_err(|error| {
        let face =
            error.face().map(|face| format!("{}: ", crate::job::operate::select::describe(model, face)));
        PartError::Mesh(format!("{}{error}", face.unwrap_or_default()))
    })
}

/// Chords below this part of the diagonal are refused: a curved face would take millions of triangles, which
/// nothing that reads a mesh is served by.
const FINEST: f64 = 1e-7;

/// The greatest distance of a mesh from its part, in file units; `key` is what the user calls the setting.
///
/// # Errors
/// [`PartError::Setting`] when it does not fit the size of the part.
pub fn chord(model: &Model, tolerance: Length, key: &'static str) -> Result<f64, PartError> {
    let unit = common_unit(model);
    let (chord, size) = (tolerance.in_unit(&unit), diagonal(model));
    if chord >= FINEST * size && chord <= size {
        return Ok(chord);
    }
    let (least, name) = (FINEST * size, &unit.name);
    let message = format!(
        "{chord} {name} does not fit this part, whose diagonal is {size} {name}; \
         expected a length from {least} to {size}"
    );
    Err(PartError::Setting { key, message })
}

/// Diagonal of the box of the vertices; 1 when they all coincide.
fn diagonal(model: &Model) -> f64 {
    let extents = crate::job::report::measure::Figures::of(model).vertex_extents;
    let length = extents.map_or(0.0, |[least, greatest]| {
        (0..3).map(|k| (greatest[k] - least[k]).powi(2)).sum::<f64>().sqrt()
    });
    if length > 0.0 { length } else { 1.0 }
}

/// The bytes of a file of triangles alone: STL, or else OFF.
#[must_use]
fn mesh_bytes(mesh: &Mesh, format: SideFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    let written = match format {
        SideFormat::Stl => stl::write_binary(mesh, "resurf", &mut bytes),
        SideFormat::StlText => stl::write_text(mesh, "resurf", &mut bytes),
        _ => off::write(mesh, &mut bytes),
    };
    written.expect("writing to memory cannot fail");
    bytes
}
