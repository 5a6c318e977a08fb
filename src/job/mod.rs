//! The job file: read, plan, run over parts, report. The only room that uses the file system.
