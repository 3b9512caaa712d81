//! The foreign calls: cuDSS and what it needs of the CUDA runtime, both looked for when a run asks for
//! them, so that the program starts without either.
use super::super::DeviceFault;
use super::super::foreign::Csr;
use libloading::Library;
use std::ffi::{c_int, c_void};
use std::ptr;
use std::sync::OnceLock;

type Opaque = *mut c_void;

/// What was loaded. The libraries stay for as long as the process, so that the functions do.
struct Api {
    malloc: unsafe extern "C" fn(*mut Opaque, usize) -> c_int,
    free: unsafe extern "C" fn(Opaque) -> c_int,
    memcpy: unsafe extern "C" fn(Opaque, *const c_void, usize, c_int) -> c_int,
    synchronize: unsafe extern "C" fn() -> c_int,
    create: unsafe extern "C" fn(*mut Opaque) -> c_int,
    destroy: unsafe extern "C" fn(Opaque) -> c_int,
    config_create: unsafe extern "C" fn(*mut Opaque) -> c_int,
    config_destroy: unsafe extern "C" fn(Opaque) -> c_int,
    data_create: unsafe extern "C" fn(Opaque, *mut Opaque) -> c_int,
    data_destroy: unsafe extern "C" fn(Opaque, Opaque) -> c_int,
    data_get: unsafe extern "C" fn(Opaque, Opaque, c_int, Opaque, usize, *mut usize) -> c_int,
    csr: unsafe extern "C" fn(
        *mut Opaque,
        i64,
        i64,
        i64,
        Opaque,
        Opaque,
        Opaque,
        Opaque,
        c_int,
        c_int,
        c_int,
        c_int,
        c_int,
    ) -> c_int,
    dense: unsafe extern "C" fn(*mut Opaque, i64, i64, i64, Opaque, c_int, c_int) -> c_int,
    matrix_destroy: unsafe extern "C" fn(Opaque) -> c_int,
    execute: unsafe extern "C" fn(Opaque, c_int, Opaque, Opaque, Opaque, Opaque, Opaque) -> c_int,
}

/// `cudaMemcpyKind`
const TO_DEVICE: c_int = 1;
const TO_HOST: c_int = 2;
/// `cudaDataType_t`: real numbers of 64 bits, signed integers of 32.
const R_64F: c_int = 1;
const R_32I: c_int = 10;
/// `cudssMatrixType_t`, `cudssMatrixViewType_t`, `cudssIndexBase_t`, `cudssLayout_t`
const GENERAL: c_int = 0;
const SYMMETRIC: c_int = 1;
const FULL: c_int = 0;
const UPPER: c_int = 2;
const BASE_ZERO: c_int = 0;
const COLUMN_MAJOR: c_int = 0;
/// `cudssDataParam_t`
const PIVOTS: c_int = 2;
const INERTIA: c_int = 3;

/// A phase of the solver, as `cudssPhase_t`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Analysis = 3,
    Factorization = 4,
    Refactorization = 8,
    Solve = 1008,
}

fn loaded() -> Result<&'static Api, DeviceFault> {
    static API: OnceLock<Result<Api, DeviceFault>> = OnceLock::new();
    API.get_or_init(Api::load).as_ref().map_err(|e| *e)
}

/// The first library of several names that is there.
fn library(names: &'static [&'static str]) -> Result<&'static Library, DeviceFault> {
    let open = |name: &&str| {
        // SAFETY: loading runs the initialisers of NVIDIA's libraries, which ask nothing of the caller.
        unsafe { Library::new(name) }.ok()
    };
    let found = names.iter().find_map(open);
    let name = names[0];
    found
        .map(|library| &*Box::leak(Box::new(library)))
        .ok_or(DeviceFault::NoLibrary { name })
}

impl Api {
    fn load() -> Result<Self, DeviceFault> {
        let runtime = library(&["libcudart.so.13", "libcudart.so.12", "libcudart.so"])?;
        let cudss = library(&["libcudss.so.0", "libcudss.so"])?;
        /// The function of a name, with the type of the field that takes it.
        macro_rules! function {
            ($library:expr, $name:literal) => {{
                // SAFETY: the types above are those of the headers of CUDA 12 and 13 and of cuDSS 0.5 to 0.7, in which enumerations
                // have the size of an int and all handles are pointers.
                let found = unsafe { $library.get(concat!($name, "\0").as_bytes()) };
                *found.map_err(|_| DeviceFault::NoFunction { name: $name })?
            }};
        }
        Ok(Api {
            malloc: function!(runtime, "cudaMalloc"),
            free: function!(runtime, "cudaFree"),
            memcpy: function!(runtime, "cudaMemcpy"),
            synchronize: function!(runtime, "cudaDeviceSynchronize"),
            create: function!(cudss, "cudssCreate"),
            destroy: function!(cudss, "cudssDestroy"),
            config_create: function!(cudss, "cudssConfigCreate"),
            config_destroy: function!(cudss, "cudssConfigDestroy"),
            data_create: function!(cudss, "cudssDataCreate"),
            data_destroy: function!(cudss, "cudssDataDestroy"),
            data_get: function!(cudss, "cudssDataGet"),
            csr: function!(cudss, "cudssMatrixCreateCsr"),
            dense: function!(cudss, "cudssMatrixCreateDn"),
            matrix_destroy: function!(cudss, "cudssMatrixDestroy"),
            execute: function!(cudss, "cudssExecute"),
        })
    }
}

fn checked(code: c_int, call: &'static str) -> Result<(), DeviceFault> {
    match code {
        0 => Ok(()),
        code => Err(DeviceFault::Call { call, code }),
    }
}

/// An array on the device.
struct Array {
    api: &'static Api,
    at: Opaque,
    bytes: usize,
}

impl Array {
    fn new<T>(api: &'static Api, len: usize) -> Result<Self, DeviceFault> {
        let bytes = len * size_of::<T>();
        let mut at = ptr::null_mut();
        // SAFETY: `at` is written by the call.
        let code = unsafe { (api.malloc)(&mut at, bytes.max(1)) };
        match code {
            0 => Ok(Array { api, at, bytes }),
            // cudaErrorMemoryAllocation
            2 => Err(DeviceFault::NoMemory { bytes }),
            code => Err(DeviceFault::NoDevice { code }),
        }
    }

    fn of<T: Copy>(api: &'static Api, values: &[T]) -> Result<Self, DeviceFault> {
        let array = Array::new::<T>(api, values.len())?;
        array.write(values)?;
        Ok(array)
    }

    fn write<T: Copy>(&self, values: &[T]) -> Result<(), DeviceFault> {
        assert_eq!(size_of_val(values), self.bytes);
        let from = values.as_ptr().cast();
        // SAFETY: both ends hold `bytes` bytes.
        let code = unsafe { (self.api.memcpy)(self.at, from, self.bytes, TO_DEVICE) };
        checked(code, "cudaMemcpy")
    }

    fn read(&self, values: &mut [f64]) -> Result<(), DeviceFault> {
        assert_eq!(size_of_val(values), self.bytes);
        let to = values.as_mut_ptr().cast();
        // SAFETY: both ends hold `bytes` bytes, and every pattern of bits is a number.
        let code = unsafe { (self.api.memcpy)(to, self.at, self.bytes, TO_HOST) };
        checked(code, "cudaMemcpy")
    }
}

impl Drop for Array {
    fn drop(&mut self) {
        // SAFETY: it was allocated by `cudaMalloc` and is freed once.
        unsafe { (self.api.free)(self.at) };
    }
}

/// An object of cuDSS.
struct Object {
    at: Opaque,
    destroy: unsafe extern "C" fn(Opaque) -> c_int,
}

impl Object {
    fn new(
        make: impl FnOnce(*mut Opaque) -> c_int,
        destroy: unsafe extern "C" fn(Opaque) -> c_int,
        call: &'static str,
    ) -> Result<Self, DeviceFault> {
        let mut at = ptr::null_mut();
        checked(make(&mut at), call)?;
        Ok(Object { at, destroy })
    }
}

impl Drop for Object {
    fn drop(&mut self) {
        // SAFETY: it was made by the call that belongs to `destroy`, and is destroyed once.
        unsafe { (self.destroy)(self.at) };
    }
}

/// A matrix on the device, with its factors. Fields are dropped from the first to the last: objects before the arrays they point to.
pub(super) struct Device {
    api: &'static Api,
    data: Opaque,
    solution: Object,
    right: Object,
    matrix: Object,
    config: Object,
    handle: Object,
    values: Array,
    x: Array,
    b: Array,
    _starts: Array,
    _columns: Array,
    symmetric: bool,
    factorized: bool,
}

// SAFETY: nothing on the device belongs to a thread: the primary context of a device is that of the process, and only one thread at a
// time has the value.
unsafe impl Send for Device {}

impl Device {
    /// A matrix of this structure, analysed.
    ///
    /// # Errors
    /// Any [`DeviceFault`].
    pub fn new(csr: &Csr) -> Result<Self, DeviceFault> {
        let api = loaded()?;
        let (n, entries) = (csr.rows() as i64, csr.entries() as i64);
        let symmetric = csr.is_symmetric();
        let starts = Array::of(api, csr.starts())?;
        let columns = Array::of(api, csr.columns())?;
        let values = Array::new::<f64>(api, csr.entries())?;
        let [x, b] = [(), ()].map(|()| Array::new::<f64>(api, csr.rows()));
        let (x, b) = (x?, b?);
        // SAFETY, of all calls below: pointers are to live objects of cuDSS or arrays on the device of the sizes that are stated,
        // which outlive the objects (see the order of the fields); results are written to places of their types.
        let handle = Object::new(|at| unsafe { (api.create)(at) }, api.destroy, "cudssCreate")?;
        let config = Object::new(
            |at| unsafe { (api.config_create)(at) },
            api.config_destroy,
            "cudssConfigCreate",
        )?;
        let (kind, view) = match symmetric {
            true => (SYMMETRIC, UPPER),
            false => (GENERAL, FULL),
        };
        let matrix = |at| unsafe {
            (api.csr)(
                at,
                n,
                n,
                entries,
                starts.at,
                ptr::null_mut(),
                columns.at,
                values.at,
                R_32I,
                R_64F,
                kind,
                view,
                BASE_ZERO,
            )
        };
        let matrix = Object::new(matrix, api.matrix_destroy, "cudssMatrixCreateCsr")?;
        let dense = |array: &Array| {
            let make = |at| unsafe { (api.dense)(at, n, 1, n, array.at, R_64F, COLUMN_MAJOR) };
            Object::new(make, api.matrix_destroy, "cudssMatrixCreateDn")
        };
        let (solution, right) = (dense(&x)?, dense(&b)?);
        let mut data = ptr::null_mut();
        checked(
            unsafe { (api.data_create)(handle.at, &mut data) },
            "cudssDataCreate",
        )?;
        let device = Device {
            api,
            data,
            solution,
            right,
            matrix,
            config,
            handle,
            values,
            x,
            b,
            _starts: starts,
            _columns: columns,
            symmetric,
            factorized: false,
        };
        device.execute(Phase::Analysis, "analysis")?;
        Ok(device)
    }

    fn execute(&self, phase: Phase, call: &'static str) -> Result<(), DeviceFault> {
        // SAFETY: all of them are objects of cuDSS that live as long as this value.
        let code = unsafe {
            (self.api.execute)(
                self.handle.at,
                phase as c_int,
                self.config.at,
                self.data,
                self.matrix.at,
                self.solution.at,
                self.right.at,
            )
        };
        checked(code, call)?;
        // SAFETY: it takes nothing.
        checked(unsafe { (self.api.synchronize)() }, call)
    }

    /// Factorizes the matrix of these values. Returns the numbers of negative and of replaced pivots; there are no negative ones of an
    /// unsymmetric matrix.
    pub fn factorize(&mut self, values: &[f64]) -> Result<[usize; 2], DeviceFault> {
        self.values.write(values)?;
        let (phase, call) = match self.factorized {
            true => (Phase::Refactorization, "refactorization"),
            false => (Phase::Factorization, "factorization"),
        };
        self.factorized = false;
        self.execute(phase, call)?;
        self.factorized = true;
        let replaced = self.get::<1>(PIVOTS)?[0];
        let negative = match self.symmetric {
            true => self.get::<2>(INERTIA)?[1],
            false => 0,
        };
        Ok([negative, replaced].map(|n| n.max(0) as usize))
    }

    fn get<const N: usize>(&self, what: c_int) -> Result<[c_int; N], DeviceFault> {
        let mut found = [0; N];
        let mut written = 0;
        // SAFETY: the size of the place is stated.
        let code = unsafe {
            (self.api.data_get)(
                self.handle.at,
                self.data,
                what,
                found.as_mut_ptr().cast(),
                size_of_val(&found),
                &mut written,
            )
        };
        checked(code, "cudssDataGet")?;
        Ok(found)
    }

    /// Overwrites a right-hand side with the solution.
    pub fn solve(&mut self, rhs: &mut [f64]) -> Result<(), DeviceFault> {
        self.b.write(rhs)?;
        self.execute(Phase::Solve, "solution")?;
        self.x.read(rhs)
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: it was made with this handle, which still lives, and is destroyed once.
        unsafe { (self.api.data_destroy)(self.handle.at, self.data) };
    }
}
