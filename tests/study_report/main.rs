//! Reports of studies: sentences, pages, pictures and tables of records with known truth.
mod csv;
mod files;
mod markup;
mod records;
mod sentences;
