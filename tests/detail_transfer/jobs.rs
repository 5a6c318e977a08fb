//! Jobs on files.
