//! Recognises the format of a file; the one place that dispatches between formats.
