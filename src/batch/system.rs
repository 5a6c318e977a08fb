//! What the operating system is asked for: a ceiling on memory, processes that end with those that they started.

use std::process::{Child, Command};

/// Sets the ceiling on the memory that this process and those that it starts may write to, where the system has one.
#[cfg(target_os = "linux")]
pub(super) fn limit_memory(bytes: u64) {
    use rustix::process::{Resource, Rlimit, setrlimit};
    // Data, not address space: an allocator reserves much more than it ever writes to.
    let limit = Rlimit { current: Some(bytes), maximum: Some(bytes) };
    // A process that may not lower its own limit works without one, as on systems that have none.
    let _ = setrlimit(Resource::Data, limit);
}

#[cfg(not(target_os = "linux"))]
pub(super) fn limit_memory(_bytes: u64) {}

/// The program itself, also when another version has taken its place on the disk since it was started.
pub(super) fn this_program() -> std::io::Result<std::path::PathBuf> {
    let running = std::path::Path::new("/proc/self/exe");
    if running.exists() { Ok(running.to_owned()) } else { std::env::current_exe() }
}

/// Lets a process lead a group, so that it can be ended with all that it starts, and the terminal's Ctrl-C does not
/// reach it before us.
#[cfg(unix)]
pub(super) fn lead_group(command: &mut Command) {
    use std::os::unix::process::CommandExt;
    command.process_group(0);
}

#[cfg(not(unix))]
pub(super) fn lead_group(_command: &mut Command) {}

/// Ends a process with its group and waits for it.
pub(super) fn end(child: &mut Child) {
    #[cfg(unix)]
    if let Some(group) = i32::try_from(child.id()).ok().and_then(rustix::process::Pid::from_raw) {
        // Fails only when nobody is left, which is what it is for.
        let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
    }
    let _ = child.kill();
    let _ = child.wait();
}

/// Ends this process with all that it started: nobody waits for the result any more.
pub(super) fn end_self(code: u8) -> ! {
    #[cfg(unix)]
    {
        use rustix::process::{Signal, getpgrp, getpid, kill_process_group};
        if getpgrp() == getpid() {
            let _ = kill_process_group(getpid(), Signal::KILL);
        }
    }
    std::process::exit(i32::from(code))
}

/// Whether the system killed a process that we did not kill: it does so when memory runs out.
pub(super) fn was_killed(status: std::process::ExitStatus) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::process::ExitStatusExt;
        status.signal() == Some(rustix::process::Signal::KILL.as_raw())
    }
    #[cfg(not(unix))]
    {
        let _ = status;
        false
    }
}
