//! The book in `docs`: every page is reached, every link leads somewhere, every tutorial does what it says.
mod commands;
mod gallery;
mod links;
mod page;
mod tutorials;
