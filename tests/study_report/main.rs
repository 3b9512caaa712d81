//! Reports of studies: sentences, pages, pictures and tables of records with known truth.
mod records;
