//! What keeps a graphics processor from solving a system.

/// Why the device did not do what was asked of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum DeviceFault {
    #[error("`{name}` was not found: install it, and name its folder in LD_LIBRARY_PATH")]
    NoLibrary { name: &'static str },
    #[error("the library that was found has no function `{name}`: it is of another version")]
    NoFunction { name: &'static str },
    #[error("no graphics processor can be used (CUDA's code {code})")]
    NoDevice { code: i32 },
    #[error("the memory of the graphics processor has no room for {bytes} bytes")]
    NoMemory { bytes: usize },
    #[error("{call} failed on the graphics processor (code {code})")]
    Call { call: &'static str, code: i32 },
}
