//! One run of a program: spawned without input, killed when its time is over, the end of its output kept.
//!
//! Does not know what the program is asked. Memory is bounded however much the program prints.

use super::{Request, ValidateError, Validator};
use std::ffi::OsStr;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use wait_timeout::ChildExt;

/// Most bytes kept of a program's output; enough for any message that is worth reading.
const KEPT: usize = 16 * 1024;

/// Time that the output may take to end after the program did: a child that the program left behind may
/// hold the pipe open for ever.
const DRAIN: Duration = Duration::from_millis(500);

/// A program that came to its own end.
#[derive(Debug)]
pub(super) struct Finished {
    /// Name, for messages.
    pub program: String,
    /// How it ended.
    pub status: ExitStatus,
    /// End of what it printed, both streams.
    pub output: String,
    /// Wall time.
    pub seconds: f64,
}

impl Finished {
    /// The error of an answer that is missing or garbled.
    pub(super) fn no_sentinel(self, reason: impl Into<String>) -> ValidateError {
        let Self { program, status, output, .. } = self;
        ValidateError::NoSentinel { program, status: status.to_string(), reason: reason.into(), output }
    }
}

/// Runs a validator's program in a directory that is also its home, so that no user settings count.
///
/// # Errors
/// `Missing`, `NotRunnable`, `Timeout`, and `Crashed` when a signal ended it. Any exit code is fine here.
pub(super) fn run(
    validator: Validator,
    arguments: &[&OsStr],
    variables: &[(&str, &OsStr)],
    directory: &Path,
    request: &Request,
) -> Result<Finished, ValidateError> {
    let name = request.program.map_or_else(|| validator.program(), OsStr::to_os_string);
    let program = name.to_string_lossy().into_owned();
    let begin = Instant::now();
    let mut child = Command::new(&name)
        .args(arguments)
        .current_dir(directory)
        .env("HOME", directory)
        .env("LC_ALL", "C.UTF-8")
        .envs(variables.iter().copied())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|source| not_started(validator, &program, source))?;
    let tail = Tail::of(&mut child);
    let waited = child.wait_timeout(request.timeout);
    let Ok(Some(status)) = waited else {
        // Both may fail only because the child is gone, which is what they are for.
        let _ = child.kill();
        let _ = child.wait();
        let output = tail.finish();
        return Err(match waited {
            Err(source) => ValidateError::NotRunnable { program, source },
            Ok(_) => ValidateError::Timeout { program, seconds: request.timeout.as_secs_f64(), output },
        });
    };
    let output = tail.finish();
    if status.code().is_none() {
        return Err(ValidateError::Crashed { program, status: status.to_string(), output });
    }
    Ok(Finished { program, status, output, seconds: begin.elapsed().as_secs_f64() })
}

fn not_started(validator: Validator, program: &str, source: std::io::Error) -> ValidateError {
    let program = program.to_owned();
    if source.kind() == std::io::ErrorKind::NotFound {
        let (install, variable) = (validator.install_command(), validator.program_variable());
        return ValidateError::Missing { program, install, variable };
    }
    ValidateError::NotRunnable { program, source }
}

/// The end of both output streams, collected while the program runs.
struct Tail {
    kept: Arc<Mutex<Vec<u8>>>,
    ended: Receiver<()>,
}

impl Tail {
    fn of(child: &mut Child) -> Self {
        let kept = Arc::default();
        let (end, ended) = channel();
        let streams: [Option<Box<dyn Read + Send>>; 2] = [
            child.stdout.take().map(|s| Box::new(s) as Box<dyn Read + Send>),
            child.stderr.take().map(|s| Box::new(s) as Box<dyn Read + Send>),
        ];
        for stream in streams.into_iter().flatten() {
            let (kept, end) = (Arc::clone(&kept), end.clone());
            std::thread::spawn(move || {
                keep_end(stream, &kept);
                // Nobody listens any more when the drain time was over.
                let _ = end.send(());
            });
        }
        Self { kept, ended }
    }

    fn finish(self) -> String {
        let deadline = Instant::now() + DRAIN;
        for _ in 0..2 {
            if self.ended.recv_timeout(deadline.saturating_duration_since(Instant::now())).is_err() {
                break;
            }
        }
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        String::from_utf8_lossy(&kept[kept.len().saturating_sub(KEPT)..]).trim().to_owned()
    }
}

fn keep_end(mut stream: impl Read, kept: &Mutex<Vec<u8>>) {
    let mut buffer = [0; 4096];
    while let Ok(count @ 1..) = stream.read(&mut buffer) {
        let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.extend_from_slice(&buffer[..count]);
        if kept.len() > 2 * KEPT {
            let excess = kept.len() - KEPT;
            kept.drain(..excess);
        }
    }
}
