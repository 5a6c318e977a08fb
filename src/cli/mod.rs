//! Flags, colours, exit codes. The only room that prints.
