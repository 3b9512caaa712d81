//! Files of which one array changes from step to step: the rest is serialised and compressed once.
use super::OutputError;
use super::appended::Appended;
use super::packed::compressed;
use super::vtu::{Array, Grid};
use flate2::Compression;
use std::sync::{Mutex, PoisonError};
use vtkio::model::IOBuffer;

/// A file without the array that changes, its last.
#[derive(Debug)]
struct Template {
    file: Appended,
    /// Whether the array is in double precision, which its tag says.
    double: bool,
}

/// The last file of a surface at one start, whose displacement alone leads to the next one.
#[derive(Debug, Default)]
pub(super) struct LastFile(Mutex<Option<(Vec<f64>, Template)>>);

/// A copy begins anew.
impl Clone for LastFile {
    fn clone(&self) -> Self {
        LastFile::default()
    }
}

impl LastFile {
    /// The bytes of the file with the array `changing` of its point data, its [`Grid::vectors`], whose other arrays and points
    /// follow from `key`: those of `grid`, which is made where they are not at hand.
    ///
    /// # Errors
    /// [`OutputError`] of the grid.
    pub fn bytes(
        &self,
        key: &[f64],
        changing: Array,
        grid: impl FnOnce(Array) -> Grid,
    ) -> Result<Vec<u8>, OutputError> {
        let numbers = match &changing.data {
            IOBuffer::F32(data) => Some((false, bytes(data, f32::to_le_bytes))),
            IOBuffer::F64(data) => Some((true, bytes(data, f64::to_le_bytes))),
            _ => None,
        };
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let (Some((of, template)), Some((double, numbers))) = (&*last, &numbers)
            && of == key
            && template.double == *double
            && let Some(contents) = compressed(numbers, Compression::fast())
        {
            return Ok(template.file.file_with(&contents));
        }
        let file = grid(changing).into_parts()?;
        let whole = file.file();
        *last = numbers.map(|(double, _)| (key.to_vec(), Template { file, double }));
        Ok(whole)
    }
}

fn bytes<T: Copy, const N: usize>(data: &[T], of: fn(T) -> [u8; N]) -> Vec<u8> {
    data.iter().flat_map(|x| of(*x)).collect()
}
