//! Flags, colours, exit codes. The only room that prints.
//!
//! Data goes to standard output, everything else to standard error. A reader that closes the pipe early
//! has got what it wanted: that is success.

mod arguments;
mod check;
mod convert;
mod diff;
pub mod exit_code;
mod feature;
mod inspect;
mod manual;
mod print;
mod progress;
mod regress;
mod report;
mod run;
mod show;
mod verify;
mod view;

use clap::Parser;

use arguments::{Arguments, Command, FeatureCommand, ReportCommand, SchemaOf};
use print::Printer;

/// Runs the program with the process's arguments and gives its exit code.
#[must_use]
pub fn main() -> u8 {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Clap prints help to standard output with code 0, and usage errors to standard error with 2.
            let code = if error.use_stderr() { exit_code::USAGE } else { exit_code::DONE };
            let _ = error.print();
            return code;
        }
    };
    let mut printer = Printer::new();
    let code = match arguments.command {
        Command::Run(arguments) => run::run(&arguments, &mut printer),
        Command::Convert(arguments) => convert::convert(&arguments, &mut printer),
        Command::Inspect(arguments) => inspect::inspect(&arguments, &mut printer),
        Command::Check(arguments) => check::check(&arguments, &mut printer),
        Command::Verify(arguments) => verify::verify(&arguments, &mut printer),
        Command::Diff(arguments) => diff::diff(&arguments, &mut printer),
        Command::Regress(arguments) => regress::regress(&arguments, &mut printer),
        Command::Report(ReportCommand::Merge(arguments)) => report::merge(&arguments, &mut printer),
        Command::View(arguments) => view::view(&arguments, &mut printer),
        Command::Feature(FeatureCommand::Export(arguments)) => feature::export(&arguments, &mut printer),
        Command::Feature(FeatureCommand::Detail(arguments)) => feature::detail(&arguments, &mut printer),
        Command::Schema { of } => {
            printer.data(&match of {
                SchemaOf::Job => crate::job::schema::job(),
                SchemaOf::Report => crate::job::schema::report(),
                SchemaOf::Feature => crate::job::schema::feature(),
                SchemaOf::Detail => crate::job::schema::detail(),
                SchemaOf::Proof => crate::job::schema::proof(),
            });
            exit_code::DONE
        }
        Command::Completions { shell } => manual::completions(shell, &mut printer),
        Command::Man { folder } => manual::pages(folder.as_deref(), &mut printer),
        Command::Worker => crate::batch::worker::work(std::io::stdin(), &mut std::io::stdout()),
    };
    printer.code().unwrap_or(code)
}
