//! What a run says while it goes on: a bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use super::print::Printer;
use super::show;
use crate::batch::Progress;
use crate::job::report::PartReport;

/// Shows the progress of one run.
pub struct Display<'a> {
    printer: &'a mut Printer,
    bar: Option<ProgressBar>,
    verbose: bool,
    /// What is said of a part that came through, behind its name.
    line: fn(&PartReport) -> String,
}

impl<'a> Display<'a> {
    /// A display that tells each step when it is `verbose`.
    pub fn new(printer: &'a mut Printer, verbose: bool, line: fn(&PartReport) -> String) -> Self {
        Self { printer, bar: None, verbose, line }
    }

    /// Shows what is told.
    pub fn show(&mut self, progress: Progress<'_>) {
        match progress {
            Progress::Begun { parts, bytes } => self.bar = bar(parts, bytes),
            Progress::Stage { input, stage } => {
                let text = format!("{}: {stage}", input.display());
                if let Some(bar) = &self.bar {
                    bar.set_message(text.clone());
                }
                if self.verbose {
                    self.lines(|printer, _| printer.line(&text));
                }
            }
            Progress::Finished { report, bytes } => {
                if let Some(bar) = &self.bar {
                    // A file without bytes is progress too.
                    bar.inc(bytes.max(1));
                }
                self.lines(|printer, line| finished(printer, report, line));
            }
        }
    }

    /// Prints above the bar.
    fn lines(&mut self, print: impl FnOnce(&mut Printer, fn(&PartReport) -> String)) {
        let Self { printer, bar, line, .. } = self;
        match bar {
            Some(bar) => bar.suspend(|| print(printer, *line)),
            None => print(printer, *line),
        }
    }

    /// Takes the bar away.
    pub fn end(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}

/// A bar by bytes: time goes by size rather than by count. None off a terminal, and none for one part.
fn bar(parts: usize, bytes: u64) -> Option<ProgressBar> {
    if parts < 2 || !std::io::stderr().is_terminal() {
        return None;
    }
    let bar = ProgressBar::new(bytes.max(parts as u64));
    let style = "{bar:30} {percent}% {bytes_per_sec} {eta} left  {wide_msg}";
    // The template is a constant that a test reads.
    bar.set_style(ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_millis(200));
    Some(bar)
}

fn finished(printer: &mut Printer, part: &PartReport, line: fn(&PartReport) -> String) {
    // What an earlier run has told is in the report; a morning's log shows what is new.
    if !part.unchanged {
        show::warnings(printer, part);
    }
    match &part.failure {
        Some(failure) => show::failure(printer, &part.input, failure),
        None => printer.line(&line(part)),
    }
}
