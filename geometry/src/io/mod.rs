//! Readers of CAD files.
