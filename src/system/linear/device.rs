//! What keeps a graphics processor from solving a system.

/// Why the device did not do what was asked of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum DeviceFault {
    /// A library is not installed, or not found.
    #[error("`{name}` was not found: install it, and name its folder in LD_LIBRARY_PATH")]
    NoLibrary {
        /// Its file name.
        name: &'static str,
    },
    /// A library lacks a function.
    #[error("the library that was found has no function `{name}`: it is of another version")]
    NoFunction {
        /// Name of the function.
        name: &'static str,
    },
    /// There is no graphics processor that can be used.
    #[error("no graphics processor can be used (CUDA's code {code})")]
    NoDevice {
        /// Error code of CUDA.
        code: i32,
    },
    /// The memory of the graphics processor is full.
    #[error("the memory of the graphics processor has no room for {bytes} bytes")]
    NoMemory {
        /// Bytes that were asked for.
        bytes: usize,
    },
    /// A call of the library failed.
    #[error("{call} failed on the graphics processor (code {code})")]
    Call {
        /// Name of the function.
        call: &'static str,
        /// Its error code.
        code: i32,
    },
}
