//! The command line's words.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::batch::limits::MemorySize;
use crate::batch::{Limits, Share};
use crate::job::file::detail::CurveSelector;
use crate::job::file::paste::RegionSetting;
use crate::job::file::selector::Selector;
use crate::job::file::{Seconds, ValidatorName};

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
    /// Tell how two parts differ, by their geometry and structure
    Diff(DiffArguments),
    /// Write one self-contained HTML page that shows a part
    View(ViewArguments),
    /// Check a proof sheet against the part before and after
    Verify(VerifyArguments),
    /// Measure the parts and jobs of a folder, and compare with a baseline
    Regress(RegressArguments),
    /// Put reports together
    #[command(subcommand)]
    Report(ReportCommand),
    /// Keep features for pastes without their parts
    #[command(subcommand)]
    Feature(FeatureCommand),
    /// Print the JSON Schema of the job file, the report, a feature, curve detail or a proof sheet
    Schema {
        /// Which one
        of: SchemaOf,
    },
    /// Print a script that completes commands and flags
    Completions {
        /// For this shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page, or write one for each command into a folder
    Man {
        /// The folder
        folder: Option<PathBuf>,
    },
    /// Do one part of a run; started by `run`, with its order on standard input
    #[command(hide = true)]
    Worker,
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
    /// Write the report as JUnit XML
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write the report as one HTML page with pictures, and a page in three dimensions for each part into a folder beside it
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Do parts again that have not changed
    #[arg(long)]
    pub fresh: bool,
    /// Do one share of the parts: I of N, or that of an array job's index (Slurm, Kubernetes, AWS Batch)
    #[arg(long, value_name = "I/N|auto/N")]
    pub shard: Option<Share>,
    /// What the run may use
    #[command(flatten)]
    pub limits: LimitArguments,
}

/// What a run over parts may use.
#[derive(Debug, Clone, Copy, Args)]
pub struct LimitArguments {
    /// Parts at a time; left out, one for each processor
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub jobs: Option<u16>,
    /// Memory for all parts at a time together, such as `8 GB`; left out, three quarters of the machine's
    #[arg(long, value_name = "SIZE")]
    pub memory: Option<MemorySize>,
    /// Seconds that one part may take
    #[arg(long, value_name = "SECONDS", default_value = "3600", value_parser = seconds)]
    pub timeout: f64,
    /// Tell each step of each part
    #[arg(short, long)]
    pub verbose: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| format!("`{text}` is no number of seconds"))?;
    Seconds::try_from(seconds).map(|seconds| seconds.0)
}

impl LimitArguments {
    /// The limits, with the machine's where nothing is said.
    #[must_use]
    pub fn limits(&self) -> Limits {
        let machine = Limits::of_machine();
        Limits {
            jobs: self.jobs.map_or(machine.jobs, usize::from),
            memory: self.memory.map_or(machine.memory, |size| Some(size.0)),
            time: Duration::from_secs_f64(self.timeout),
        }
    }
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
    /// Application protocol of a STEP file that is made of an IGES file
    #[arg(long)]
    pub schema: Option<SchemaWord>,
    /// What solids become in an IGES file that is made of a STEP file
    #[arg(long)]
    pub solids: Option<SolidsWord>,
}

/// Application protocols of new STEP files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SchemaWord {
    /// ISO 10303-214
    Ap214,
    /// ISO 10303-242
    Ap242,
}

impl From<SchemaWord> for crate::document::Schema {
    fn from(word: SchemaWord) -> Self {
        match word {
            SchemaWord::Ap214 => Self::Ap214,
            SchemaWord::Ap242 => Self::Ap242,
        }
    }
}

/// What solids become in new IGES files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SolidsWord {
    /// Manifold solid B-rep objects (186)
    Brep,
    /// Trimmed surfaces (144), for readers that know nothing else
    Trimmed,
}

impl From<SolidsWord> for crate::document::Solids {
    fn from(word: SolidsWord) -> Self {
        match word {
            SolidsWord::Brep => Self::Brep,
            SolidsWord::Trimmed => Self::Trimmed,
        }
    }
}

/// Formats that are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Target {
    /// STEP: the own bytes of a STEP file, or one made of an IGES file
    Step,
    /// IGES: the own bytes of an IGES file, or one made of a STEP file
    Iges,
    /// Binary STL
    Stl,
    /// STL as text, with coordinates that read back to the same bits
    StlText,
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

/// Arguments of `diff`.
#[derive(Debug, Args)]
pub struct DiffArguments {
    /// First part
    #[arg(value_name = "A")]
    pub before: PathBuf,
    /// Second part
    #[arg(value_name = "B")]
    pub after: PathBuf,
    /// Distance within which points count as one: a number in the first file's units, or with a unit; left out, the greatest
    /// of the files' uncertainties and a millionth of the size
    #[arg(long, value_name = "LENGTH")]
    pub tolerance: Option<crate::units::Length>,
    /// Look at one side only
    #[arg(long)]
    pub only: Option<Aspect>,
    /// Write JSON
    #[arg(long)]
    pub json: bool,
    /// Write a page that shows the second part with the distances as colours
    #[arg(long, value_name = "PAGE")]
    pub html: Option<PathBuf>,
}

/// What `diff` looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Aspect {
    /// Faces and free curves
    Geometry,
    /// Products, names, looks, units, annotations
    Structure,
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

/// Arguments of `regress`.
#[derive(Debug, Args)]
pub struct RegressArguments {
    /// Folder with parts and jobs
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// What they measured before, in TOML
    #[arg(long, value_name = "FILE")]
    pub baseline: PathBuf,
    /// Make what they measure now the baseline
    #[arg(long)]
    pub update: bool,
    /// Ask these programs about every part
    #[arg(long, value_delimiter = ',', value_name = "PROGRAMS")]
    pub with: Vec<ValidatorName>,
    /// Write JUnit XML
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write JSON
    #[arg(long)]
    pub json: bool,
    /// What it may use
    #[command(flatten)]
    pub limits: LimitArguments,
}

/// The commands of `report`.
#[derive(Debug, Subcommand)]
pub enum ReportCommand {
    /// Put the reports of the shares of a run together
    Merge(MergeArguments),
}

/// Arguments of `report merge`.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// Reports of all shares, JSON
    #[arg(required = true, value_name = "REPORT")]
    pub reports: Vec<PathBuf>,
    /// Report to write, JSON
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Write JUnit XML
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Write the report as one HTML page with pictures, and a page in three dimensions for each part into a folder beside it
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the report as JSON to standard output
    #[arg(long)]
    pub json: bool,
    /// What drawing the pictures may use
    #[command(flatten)]
    pub limits: LimitArguments,
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

/// Arguments of `verify`.
#[derive(Debug, Args)]
pub struct VerifyArguments {
    /// Proof sheet that a run wrote
    #[arg(value_name = "PROOF")]
    pub proof: PathBuf,
    /// The part before the run
    #[arg(value_name = "BEFORE")]
    pub before: PathBuf,
    /// The part after it
    #[arg(value_name = "AFTER")]
    pub after: PathBuf,
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
    /// A proof sheet
    Proof,
}
