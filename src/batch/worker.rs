//! The worker's side: one task, done in a process that may die of it.

use std::io::{BufRead, BufReader, Read, Write};

use super::system;
use super::task::{Order, Task, Word};
use crate::job::failure::{PartError, code};
use crate::job::report::measured::measured;
use crate::job::run::run_part;
use crate::job::side::illustrate::illustrate;

/// Longest order: a job's text and two paths.
const LONGEST: u64 = 1 << 28;

/// Does the one task that stands in the first line of `input`, and answers in lines of `output`. When `input` ends before the
/// task does, the run is gone, and so is the process.
///
/// Gives an exit code: the task's own outcome stands in the answer, and this one is 0 whenever there is one.
pub fn work(input: impl Read + Send + 'static, output: &mut dyn Write) -> u8 {
    let mut input = BufReader::new(input.take(LONGEST));
    let mut line = String::new();
    let read = input.read_line(&mut line);
    let order: Option<Order> = read.ok().and_then(|_| serde_json::from_str(&line).ok());
    let Some(Order { task, memory, threads }) = order else { return code::USAGE };
    // Threads first: a pool that cannot be made under a low ceiling would pass for a bug.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    std::thread::spawn(move || {
        let _ = std::io::copy(&mut input, &mut std::io::sink());
        system::end_self(code::INTERRUPTED);
    });
    if let Some(bytes) = memory {
        system::limit_memory(bytes);
    }
    let mut say = |word: &Word| {
        let text = serde_json::to_string(word).map_err(std::io::Error::other)?;
        writeln!(output, "{text}").and_then(|()| output.flush())
    };
    let said = match task {
        Task::Run { job, part, mode } => {
            let Ok(job) = job.job() else { return code::USAGE };
            // A run that does not listen any more ends the process by closing its input.
            let mut watch = |stage| drop(say(&Word::Stage(stage)));
            let report = run_part(&job, &part, mode, &mut watch);
            say(&Word::Ran(Box::new(report)))
        }
        Task::Measure { part, validators } => {
            let failed = |error: PartError| {
                let failure = error.failure();
                (failure.code, failure.message)
            };
            say(&Word::Measured(measured(&part, &validators).map_err(failed)))
        }
        Task::Illustrate { part, page } => {
            let drawn = illustrate(&part.input, &part.output, &page);
            say(&Word::Drawn(drawn.map_err(|error| error.to_string())))
        }
    };
    if said.is_ok() { code::DONE } else { code::IO }
}
