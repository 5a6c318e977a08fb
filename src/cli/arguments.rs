//! The command line's words.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::job::detail_file::CurveSelector;
use crate::job::file::ValidatorName;
use crate::job::paste_file::RegionSetting;
use crate::job::selector::Selector;

/// Freeform operations on exchanged CAD parts, with everything else kept byte for byte.
///
/// Exit codes: 0 all well; 1 a part failed its gate; 2 usage or job file wrong; 3 input unreadable;
/// 4 operation cannot be done; 5 required validator missing; 6 resource ceiling; 7 I/O, try again;
/// 70 internal error; 130 interrupted.
#[derive(Debug, Parser)]
#[command(name = "resurf", version, about, long_about)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Apply a job to its parts
    Run(RunArguments),
    /// Pass a part through, or write its mesh
    Convert(ConvertArguments),
    /// Show what is inside a part
    Inspect(InspectArguments),
    /// Check parts, and ask other programs about them
    Check(CheckArguments),
    /// Write one self-contained HTML page that shows a part
    View(ViewArguments),
    /// Keep features for pastes without their parts
    #[command(subcommand)]
    Feature(FeatureCommand),
    /// Print the JSON Schema of the job file, the report, a feature or curve detail
    Schema {
        /// Which one
        of: SchemaOf,
    },
}

/// Arguments of `run`.
#[derive(Debug, Args)]
pub struct RunArguments {
    /// Job file, TOML or JSON
    #[arg(value_name = "JOB")]
    pub job: PathBuf,
    /// Do everything but write and ask other programs
    #[arg(long)]
    pub dry_run: bool,
    /// Write the report as JSON to standard output
    #[arg(long)]
    pub json: bool,
    /// Write the report as JSON to a file as well
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
}

/// Arguments of `convert`.
#[derive(Debug, Args)]
pub struct ConvertArguments {
    /// Parts to read
    #[arg(required = true, value_name = "IN")]
    pub inputs: Vec<PathBuf>,
    /// File to write, or folder for several parts
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Format to write; left out, the output's extension decides
    #[arg(long)]
    pub to: Option<Target>,
    /// Greatest distance of a mesh from its part: a number in file units, or with a unit
    #[arg(long, value_name = "LENGTH")]
    pub tolerance: Option<crate::units::Length>,
}

/// Formats that are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Target {
    /// The own bytes of a STEP file
    Step,
    /// The own bytes of an IGES file
    Iges,
    /// Binary STL
    Stl,
    /// OFF
    Off,
    /// 3MF with names and colours
    #[value(name = "3mf")]
    ThreeMf,
    /// Binary glTF with names and colours
    Glb,
}

/// Arguments of `inspect`.
#[derive(Debug, Args)]
pub struct InspectArguments {
    /// Part to read
    #[arg(value_name = "PART")]
    pub part: PathBuf,
    /// Write JSON
    #[arg(long)]
    pub json: bool,
    /// Show these faces: `#1042`, or a table as in a job file
    #[arg(long, value_name = "SELECTOR")]
    pub face: Option<Selector>,
    /// Show all faces
    #[arg(long)]
    pub faces: bool,
    /// Measure volume, area and centroid of each body; takes seconds where faces have thousands of control points
    #[arg(long)]
    pub measure: bool,
}

/// Arguments of `view`.
#[derive(Debug, Args)]
pub struct ViewArguments {
    /// Part to read
    #[arg(value_name = "PART")]
    pub part: PathBuf,
    /// Page to write
    #[arg(short, long, value_name = "PAGE")]
    pub output: PathBuf,
    /// Greatest distance of the triangles from the part: a number in file units, or with a unit
    #[arg(long, value_name = "LENGTH")]
    pub tolerance: Option<crate::units::Length>,
}

/// The commands of `feature`.
#[derive(Debug, Subcommand)]
pub enum FeatureCommand {
    /// Take a feature off a face, and write it to a file of its own
    Export(ExportArguments),
    /// Split a curve into its base and levels of detail, and write them to a file of their own
    Detail(DetailArguments),
}

/// Arguments of `feature detail`.
#[derive(Debug, Args)]
pub struct DetailArguments {
    /// Part to read
    #[arg(value_name = "PART")]
    pub part: PathBuf,
    /// The curve: `#1042`, or a table as in a job file; left out, the only free one
    #[arg(long, value_name = "SELECTOR")]
    pub curve: Option<CurveSelector>,
    /// File to write
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// Arguments of `feature export`.
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// Part to read
    #[arg(value_name = "PART")]
    pub part: PathBuf,
    /// The face: `#1042`, or a table as in a job file; left out, the only one
    #[arg(long, value_name = "SELECTOR")]
    pub face: Option<Selector>,
    /// What holds the feature: a table as `source.region` of a job; left out, the outer loop
    #[arg(long, value_name = "REGION")]
    pub region: Option<RegionSetting>,
    /// File to write
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct CheckArguments {
    /// Parts to check
    #[arg(required = true, value_name = "PART")]
    pub parts: Vec<PathBuf>,
    /// Ask these programs
    #[arg(long, value_delimiter = ',', value_name = "PROGRAMS")]
    pub with: Vec<ValidatorName>,
    /// Write JSON
    #[arg(long)]
    pub json: bool,
}

/// What `schema` prints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SchemaOf {
    /// The job file
    Job,
    /// The report
    Report,
    /// A feature of a library
    Feature,
    /// Curve detail of a library
    Detail,
}
