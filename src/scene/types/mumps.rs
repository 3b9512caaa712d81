//! Settings of MUMPS, where it solves the systems.
use schemars::JsonSchema;
use serde::de::{self, Deserializer, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::PathBuf;

/// MUMPS, which is loaded when a run asks for it.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Mumps {
    /// Order of elimination.
    pub ordering: MumpsOrdering,
    /// Keep the factors on the disk instead of in memory: `true` for the folder of temporary files, or a folder, relative to the
    /// scene file.
    pub out_of_core: OutOfCore,
}

/// Order of elimination.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MumpsOrdering {
    /// Of approximate minimum degree and nested dissection the one with fewer operations, as in covact's own factorizations.
    #[default]
    Auto,
    /// Nested dissection by METIS, as covact has it.
    Metis,
    /// Approximate minimum degree, as covact has it.
    Amd,
    /// Nested dissection by SCOTCH, if the library was built with it.
    Scotch,
    /// PORD, if the library was built with it.
    Pord,
    /// Approximate minimum fill.
    Amf,
    /// Approximate minimum degree that sees rows which are nearly full.
    Qamd,
}

impl MumpsOrdering {
    /// The name in scenes.
    pub const fn name(self) -> &'static str {
        match self {
            MumpsOrdering::Auto => "auto",
            MumpsOrdering::Metis => "metis",
            MumpsOrdering::Amd => "amd",
            MumpsOrdering::Scotch => "scotch",
            MumpsOrdering::Pord => "pord",
            MumpsOrdering::Amf => "amf",
            MumpsOrdering::Qamd => "qamd",
        }
    }
}

/// Whether factors are kept on the disk, and where.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum OutOfCore {
    /// `true`: in the folder of temporary files.
    Temporary(bool),
    /// In this folder.
    Folder(PathBuf),
}

impl Default for OutOfCore {
    fn default() -> Self {
        OutOfCore::Temporary(false)
    }
}

// serde's own reading of untagged enums forgets where a fault was.
impl<'de> Deserialize<'de> for OutOfCore {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<OutOfCore, D::Error> {
        deserializer.deserialize_newtype_struct("OutOfCore", OutOfCoreVisitor)
    }
}

struct OutOfCoreVisitor;

impl<'de> Visitor<'de> for OutOfCoreVisitor {
    type Value = OutOfCore;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("`true`, `false` or a folder")
    }
    fn visit_newtype_struct<D: Deserializer<'de>>(self, inner: D) -> Result<OutOfCore, D::Error> {
        inner.deserialize_any(self)
    }
    fn visit_bool<E: de::Error>(self, on: bool) -> Result<OutOfCore, E> {
        Ok(OutOfCore::Temporary(on))
    }
    fn visit_str<E: de::Error>(self, folder: &str) -> Result<OutOfCore, E> {
        Ok(OutOfCore::Folder(folder.into()))
    }
}
