//! The library of MUMPS, which is looked for when a run asks for it, so that the program needs nothing of it to be built or
//! started.
//!
//! It is loaded rather than linked: one program then serves every version whose structure is known (see
//! [`layout`](super::layout)), and machines without the library. What makes that safe is that the structure is never taken for
//! granted: the library fills more room than any version needs, and is used on only if the version that it writes there is a known
//! one, at the place that the layout of that version says.
use super::super::MumpsFault;
use libloading::Library;
use std::ffi::c_void;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// Names of the sequential library, the one of the development files first.
const NAMES: &[&str] = &[
    "libdmumps_seq.so",
    "libdmumps_seq-5.9.so",
    "libdmumps_seq-5.8.so",
    "libdmumps_seq-5.7.so",
    "libdmumps_seq-5.5.so",
    "libdmumps_seq-5.4.so",
    "libdmumps_seq-5.3.so",
];

/// What was loaded. The library stays for as long as the process, so that the function does.
pub(super) struct Api {
    function: unsafe extern "C" fn(*mut c_void),
}

/// The library keeps much in variables of its own: one call at a time.
static CALLING: Mutex<()> = Mutex::new(());

impl Api {
    /// The library, loaded once.
    ///
    /// # Errors
    /// [`MumpsFault::NoLibrary`], [`MumpsFault::NoFunction`].
    pub fn get() -> Result<&'static Api, MumpsFault> {
        static API: OnceLock<Result<Api, MumpsFault>> = OnceLock::new();
        API.get_or_init(Api::load).as_ref().map_err(|e| *e)
    }

    fn load() -> Result<Self, MumpsFault> {
        let open = |name: &&str| {
            // SAFETY: loading runs the initialisers of the library and of the Fortran runtime, which ask nothing of the caller.
            unsafe { Library::new(name) }.ok()
        };
        let name = NAMES[0];
        let library = NAMES.iter().find_map(open);
        let library = library.ok_or(MumpsFault::NoLibrary { name })?;
        let library: &'static Library = Box::leak(Box::new(library));
        let name = "dmumps_c";
        // SAFETY: the function takes a pointer to its structure and returns nothing, in all versions.
        let function = unsafe { library.get(b"dmumps_c\0") };
        let function = *function.map_err(|_| MumpsFault::NoFunction { name })?;
        Ok(Api { function })
    }

    /// Calls the library.
    ///
    /// # Safety
    /// `structure` points to the structure of an instance, with room for that of any version, and everything that its pointers
    /// point to is as large as the job of the call asks for.
    pub unsafe fn call(&self, structure: *mut c_void) {
        let _one: MutexGuard<'_, ()> = CALLING.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: as the caller says.
        unsafe { (self.function)(structure) }
    }
}
