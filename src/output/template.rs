//! Files of which one array changes from step to step: the rest is serialised and compressed once.
use super::OutputError;
use super::packed::compressed;
use super::vtu::{Array, Grid};
use std::sync::{Mutex, PoisonError};
use vtkio::model::IOBuffer;

/// A file around the contents of one of its arrays.
#[derive(Debug)]
struct Template {
    head: Vec<u8>,
    tail: Vec<u8>,
    /// Whether the array is in double precision, which its tag says.
    double: bool,
}

impl Template {
    /// The file around the array `name`; none where it has none.
    fn new(file: &[u8], name: &str, double: bool) -> Option<Self> {
        let tag = format!(" Name=\"{name}\"");
        let find = |from: usize, what: &[u8]| {
            let rest = file.get(from..)?;
            let at = rest.windows(what.len()).position(|w| w == what)?;
            Some(from + at)
        };
        let contents = find(find(0, tag.as_bytes())?, b">")? + 1;
        let end = find(contents, b"<")?;
        Some(Template {
            head: file[..contents].to_vec(),
            tail: file[end..].to_vec(),
            double,
        })
    }

    fn file(&self, contents: &str) -> Vec<u8> {
        [&self.head, contents.as_bytes(), &self.tail].concat()
    }
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
    /// The bytes of the file with the array `changing` of its point data, whose other arrays and points follow from `key`: those of
    /// `grid`, which is made where they are not at hand.
    ///
    /// # Errors
    /// [`OutputError`] of the grid.
    pub fn bytes(
        &self,
        key: &[f64],
        changing: Array,
        grid: impl FnOnce(Array) -> Grid,
    ) -> Result<Vec<u8>, OutputError> {
        let name = changing.name.clone();
        let numbers = match &changing.data {
            IOBuffer::F32(data) => Some((false, bytes(data, f32::to_le_bytes))),
            IOBuffer::F64(data) => Some((true, bytes(data, f64::to_le_bytes))),
            _ => None,
        };
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let (Some((of, template)), Some((double, numbers))) = (&*last, &numbers)
            && of == key
            && template.double == *double
            && let Some(contents) = compressed(numbers)
        {
            return Ok(template.file(&contents));
        }
        let file = grid(changing).into_bytes()?;
        let template = numbers.and_then(|(double, _)| Template::new(&file, &name, double));
        *last = template.map(|template| (key.to_vec(), template));
        Ok(file)
    }
}

fn bytes<T: Copy, const N: usize>(data: &[T], of: fn(T) -> [u8; N]) -> Vec<u8> {
    data.iter().flat_map(|x| of(*x)).collect()
}
