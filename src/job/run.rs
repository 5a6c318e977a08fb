//! Runs a job on one part: it is read, changed, written beside its place, read again, judged by
//! others, and only then moved into place.

use std::collections::{BTreeMap, BTreeSet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::brep::FaceId;
use crate::document::{Document, Stamp};
use crate::job::failure::PartError;
use crate::job::file::{Job, Operation};
use crate::job::flagged::flagged;
use crate::job::held::HeldRecords;
use crate::job::judge;
use crate::job::operate::{Operated, operate};
use crate::job::output::Staged;
use crate::job::own_check::{OwnFinding, changed_faces, findings_of_faces, new_findings, with_neighbours};
use crate::job::part::Read;
use crate::job::plan::Part;
use crate::job::report::measure::Figures;
use crate::job::report::{DiagnosticReport, Edits, PartReport, Status, WritePath};
use crate::job::restate::{self, Outcome, restated};
use crate::job::side::{self, Made};
use crate::model::change_set::{NewFace, NewSurface};
use crate::model::{AnnotationKind, Balance, ChangeSet, Model, Origin};

/// Whether a run writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// Writes outputs.
    Write,
    /// Does everything but write and ask other programs.
    DryRun,
}

/// What is being done to a part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// The input is read.
    Read,
    /// An operation is carried out.
    Operation {
        /// Its number in the job, from 1.
        number: usize,
        /// Operations of the job.
        of: usize,
        /// The word of the job file.
        kind: String,
    },
    /// The result is read again and compared.
    Check,
    /// The result is written beside its place, and other programs are asked about it.
    Judge,
}

impl std::fmt::Display for Stage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Read => f.write_str("reading"),
            Self::Operation { number, of, kind } => write!(f, "operation {number} of {of}, {kind}"),
            Self::Check => f.write_str("checking"),
            Self::Judge => f.write_str("writing and validating"),
        }
    }
}

/// Name and version of the program, as reports and changed headers have them.
#[must_use]
pub fn program() -> String {
    format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"))
}

/// Runs a job on one part. `watch` is told what is being done.
pub fn run_part(job: &Job, part: &Part, mode: Mode, watch: &mut dyn FnMut(Stage)) -> PartReport {
    let stamp = Stamp { time: crate::job::clock::time_stamp(), preprocessor: program() };
    let start = Instant::now();
    let name = |path: &Path| path.to_string_lossy().into_owned();
    let mut report = PartReport::new(name(&part.input), name(&part.output));
    let done = catch_unwind(AssertUnwindSafe(|| go(job, part, mode, &stamp, watch, &mut report)));
    match done.unwrap_or(Err(PartError::Internal)) {
        Ok(()) => report.status = Status::Done,
        Err(error) => report.fail(&error),
    }
    report.seconds = start.elapsed().as_secs_f64();
    report.peak_bytes = peak_bytes();
    report
}

fn go(
    job: &Job,
    part: &Part,
    mode: Mode,
    stamp: &Stamp,
    watch: &mut dyn FnMut(Stage),
    report: &mut PartReport,
) -> Result<(), PartError> {
    watch(Stage::Read);
    let mut read = Read::file(&part.input)?;
    read.refuse_other_format(&part.output)?;
    let result = changed_bytes(job, part, &mut read, stamp, watch, report);
    report.take_diagnostics(&read.diagnostics, read.document.source());
    let result = result?;
    let changed = &result.bytes;
    // The input's bytes serve again when nothing changed: a copy would double the memory.
    let bytes = changed.as_deref().unwrap_or_else(|| read.document.source().bytes());
    watch(Stage::Check);
    let wanted = [job.operation.is_empty(), job.also.is_empty(), job.pictures.is_empty()];
    let needs_model = wanted.contains(&false) || !job.validate.with.is_empty();
    let after = if needs_model { Some(read_again(job, part, bytes, &result, report)?) } else { None };
    if let Some((_, model)) = &after {
        chord(job, model)?;
    }
    if mode == Mode::DryRun {
        return Ok(());
    }
    watch(Stage::Judge);
    let staged = Staged::write(&part.output, bytes).map_err(PartError::Output)?;
    let mut sides = Vec::new();
    if let Some((document, model)) = &after {
        let made = Made {
            before: (&read.document, result.model.as_ref().unwrap_or(model)),
            after: (document, model),
            held: result.held.groups(),
            program: &stamp.preprocessor,
        };
        sides = side::staged(job, part, &made, chord(job, model)?, report)?;
        let judged = judge::judge(&job.validate, staged.path(), model, None)?;
        report.validators = judged.verdicts;
        report.losses.extend(
            judged.unasked.into_iter().map(|text| DiagnosticReport::warning("validate.not-asked", text)),
        );
        report.losses.extend(
            judge::other_counts(&report.validators, model)
                .map(|text| DiagnosticReport::warning("validate.face-count", text)),
        );
        judge::refuse(&report.validators)?;
    }
    for side in sides {
        side.commit().map_err(PartError::Output)?;
    }
    staged.commit().map_err(PartError::Output)
}

/// What a job makes of an input.
#[derive(Debug, Default)]
struct Changed {
    /// The bytes of the result; `None` when nothing changes.
    bytes: Option<Vec<u8>>,
    /// What the input means, where operations had to know.
    model: Option<Model>,
    /// Records that were held.
    held: HeldRecords,
    /// Faces that the operations change, with their neighbours.
    touched: BTreeSet<Origin>,
    /// All faces of the input.
    known: BTreeSet<Origin>,
    /// Facts that the input already violated on these.
    findings: Vec<OwnFinding>,
    /// Count of surfaces by kind that the result must have.
    surfaces: BTreeMap<String, usize>,
    /// By how much the counts of the result must differ.
    balance: Balance,
}

fn changed_bytes(
    job: &Job,
    part: &Part,
    read: &mut Read,
    stamp: &Stamp,
    watch: &mut dyn FnMut(Stage),
    report: &mut PartReport,
) -> Result<Changed, PartError> {
    report.write_path = Some(WritePath::Verbatim);
    if job.operation.is_empty() {
        read.look_for_overflow();
        read.refuse_damage()?;
        return Ok(Changed::default());
    }
    read.refuse_damage()?;
    let model = read.model();
    read.refuse_errors()?;
    // A bound that does not fit is the job's fault: it is told before the work, not after.
    chord(job, &model)?;
    report.before = Some(Figures::of(&model));
    let mut surfaces = Figures::of(&model).surfaces;
    let mut balance = Balance::default();
    let mut bytes: Option<Vec<u8>> = None;
    let mut faces: BTreeSet<Origin> = BTreeSet::new();
    let mut concerned = restate::Changed::default();
    let mut held = HeldRecords::default();
    for (at, operation) in job.operation.iter().enumerate() {
        let kind = operation.kind().to_owned();
        watch(Stage::Operation { number: at + 1, of: job.operation.len(), kind });
        // Each operation reads what the ones before it would have written.
        let between = bytes.as_ref().map(|bytes| read_between(bytes, part)).transpose()?;
        let (document, model) = match &between {
            Some((read, model)) => (&read.document, model),
            None => (&read.document, &model),
        };
        let Operated { changes, report: told, held: pieces } = operate(model, document.source(), operation)?;
        report.operations.push(told);
        held.follow(model, &changes, &pieces);
        let patch = document.lower(model, &changes, stamp)?;
        let edits: Edits = patch.counts().into();
        report.edits = Some(report.edits.map_or(edits, |before| before.followed_by(&edits)));
        if !patch.is_empty() {
            count_kinds(&mut surfaces, model, &changes);
            let changed = changed_faces(model, &changes);
            concerned.add(model, &changed);
            faces.extend(with_neighbours(model, changed));
            balance.add(Balance::of(model, &changes));
            bytes = Some(patch.apply(document.source().bytes()));
        }
    }
    let Some(bytes) = bytes else {
        return Ok(Changed { model: Some(model), held, ..Changed::default() });
    };
    report.write_path = Some(WritePath::Patched);
    let bytes = Some(state_anew(bytes, part, &model, &concerned, stamp, report)?);
    report.losses.extend(flagged(&read.document, &model, &concerned));
    let findings = findings_of_faces(&read.document, &model, &faces, 1.0);
    let known = model.origins.faces.iter().map(|(_, origin)| *origin).collect();
    Ok(Changed { bytes, model: Some(model), held, touched: faces, known, findings, surfaces, balance })
}

/// What an operation has made, as the next one finds it.
fn read_between(bytes: &[u8], part: &Part) -> Result<(Read, Model), PartError> {
    let extension = part.output.extension().and_then(|e| e.to_str()).unwrap_or_default();
    let mut read = Read::bytes(bytes.to_vec(), extension)?;
    let model = read.model();
    read.refuse_errors()?;
    Ok((read, model))
}

/// States anew what the file says of the changed shape.
fn state_anew(
    bytes: Vec<u8>,
    part: &Part,
    before: &Model,
    concerned: &restate::Changed,
    stamp: &Stamp,
    report: &mut PartReport,
) -> Result<Vec<u8>, PartError> {
    if !before.annotations.iter().any(|a| a.kind == AnnotationKind::ValidationProperty) {
        return Ok(bytes);
    }
    let (read, after) = read_between(&bytes, part)?;
    let (changes, told) = restated(before, &after, concerned);
    report.restated = told;
    let patch = read.document.lower(&after, &changes, stamp)?;
    if patch.is_empty() {
        return Ok(bytes);
    }
    let edits: Edits = patch.counts().into();
    report.edits = Some(report.edits.map_or(edits, |before| before.followed_by(&edits)));
    Ok(patch.apply(&bytes))
}

/// Tells what became of statements about the shape: what was to go may still stand there.
fn tell_restated(document: &Document, report: &mut PartReport) {
    for told in &mut report.restated {
        let line = told.origin.and_then(|origin| document.line_of(origin));
        if told.outcome == Outcome::Removed && line.is_some() {
            told.was_kept();
        }
        let what = match told.outcome {
            Outcome::Recomputed if told.reason.is_none() => continue,
            Outcome::Recomputed => ("validation-property.stale", "is stated anew but for a part"),
            Outcome::Removed => ("validation-property.removed", "is stated no more"),
            Outcome::Kept => ("validation-property.stale", "is stated as it was before the change"),
        };
        let reason = told.reason.as_deref().unwrap_or_default();
        report.losses.push(DiagnosticReport {
            entity: Some(told.entity.clone()),
            line,
            ..DiagnosticReport::warning(what.0, format!("'{}' {}: {reason}", told.name, what.1))
        });
    }
}

/// Counts of surfaces by kind, as a change set will leave them.
fn count_kinds(surfaces: &mut BTreeMap<String, usize>, model: &Model, changes: &ChangeSet) {
    let own = |face: &FaceId| crate::job::report::measure::kind(model.brep.surface_of(*face));
    let kind = |face: &NewFace| match &face.surface {
        NewSurface::Own(surface) => surface.kind().to_owned(),
        NewSurface::Of(old) => {
            changes.surfaces.get(old).map_or_else(|| own(old), |new| new.kind().to_owned())
        }
    };
    let changed = changes.surfaces.values().map(|new| new.kind().to_owned());
    for new in changed.chain(changes.new_faces.iter().map(kind)) {
        *surfaces.entry(new).or_insert(0) += 1;
    }
    for face in changes.surfaces.keys().chain(&changes.removed_faces) {
        surfaces.entry(own(face)).and_modify(|count| *count = count.saturating_sub(1));
    }
    surfaces.retain(|_, count| *count > 0);
}

/// Reads the result as anybody else would, and compares it with the input.
fn read_again(
    job: &Job,
    part: &Part,
    bytes: &[u8],
    wanted: &Changed,
    report: &mut PartReport,
) -> Result<(Document, Model), PartError> {
    let extension = part.output.extension().and_then(|e| e.to_str()).unwrap_or_default();
    let mut read = Read::bytes(bytes.to_vec(), extension)?;
    let model = read.model();
    let after = Figures::of(&model);
    let mut findings = Vec::new();
    if let Some(before) = &report.before {
        for (name, was, is) in before.counts_beside(&after) {
            if was.checked_add_signed(wanted.balance.count(name)) != Some(is) {
                findings.push(format!("{name}: {was} before, {is} after"));
            }
        }
        let surfaces = if wanted.bytes.is_some() { &wanted.surfaces } else { &before.surfaces };
        if *surfaces != after.surfaces {
            findings.push("the kinds of the surfaces differ".to_owned());
        }
    }
    for (code, count) in read.diagnostics.counts() {
        let before = report.diagnostic_counts.get(*code).copied().unwrap_or(0);
        if *count > before && report.before.is_some() {
            findings.push(format!("{code}: {before} before, {count} after"));
        }
    }
    if report.write_path == Some(WritePath::Patched) {
        tell_restated(&read.document, report);
        // Of the operations, not of the part's box: a part of an assembly may grow while the box stays.
        let growth = job.operation.iter().map(Operation::growth).product();
        let new = model.origins.faces.iter().map(|(_, origin)| *origin);
        let mut faces = wanted.touched.clone();
        faces.extend(new.filter(|origin| !wanted.known.contains(origin)));
        let own = findings_of_faces(&read.document, &model, &faces, growth);
        let new = new_findings(&wanted.findings, &own, growth).filter(|finding| finding.fails_a_change);
        findings.extend(new.map(ToString::to_string));
        report.findings = own;
    }
    report.after = Some(after);
    if findings.is_empty() { Ok((read.document, model)) } else { Err(PartError::Check(findings)) }
}

/// The job's bound on its side meshes.
fn chord(job: &Job, model: &Model) -> Result<Option<f64>, PartError> {
    let wanted = job.tolerance.length.filter(|_| !job.also.is_empty());
    wanted.map(|length| judge::chord(model, length.0, "tolerance.length")).transpose()
}

/// Greatest resident memory of the process, where Linux tells.
fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches("kB").trim().parse::<u64>().ok().map(|kilobytes| kilobytes * 1024)
}
