//! `resurf completions` and `resurf man`: what the shell and `man` want to know, made from the command line's own words.

use std::path::Path;

use clap::CommandFactory;
use clap_complete::Shell;
use clap_mangen::Man;

use super::arguments::Arguments;
use super::exit_code;
use super::print::Printer;
use crate::diagnostic::Severity;
use crate::job::output::Staged;

/// Prints a completion script.
pub fn completions(shell: Shell, printer: &mut Printer) -> u8 {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "resurf", &mut text);
    printer.data(&String::from_utf8_lossy(&text));
    exit_code::DONE
}

/// Prints the manual page of the program, or writes those of all commands into a folder.
pub fn pages(folder: Option<&Path>, printer: &mut Printer) -> u8 {
    let command = Arguments::command();
    let Some(folder) = folder else {
        printer.data(&page(command));
        return exit_code::DONE;
    };
    // Clap gives commands of commands their full names only once it was built.
    let mut command = command;
    command.build();
    let mut ahead = vec![command];
    while let Some(command) = ahead.pop() {
        ahead.extend(
            command.get_subcommands().filter(|c| !c.is_hide_set() && c.get_name() != "help").cloned(),
        );
        let name = command.get_display_name().unwrap_or_else(|| command.get_name()).to_owned();
        let place = folder.join(format!("{name}.1"));
        let written =
            Staged::write(&place, page(command.display_name(name)).as_bytes()).and_then(Staged::commit);
        if let Err(error) = written {
            printer.message(Severity::Error, &format!("the manual page cannot be written: {error}"));
            return exit_code::IO;
        }
    }
    exit_code::DONE
}

fn page(command: clap::Command) -> String {
    let mut text = Vec::new();
    // Writing into memory does not fail.
    let _ = Man::new(command).render(&mut text);
    String::from_utf8_lossy(&text).into_owned()
}
