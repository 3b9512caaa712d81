//! Threads: no more than the machine can run at once.

/// Threads that run at once on what this process has of the machine.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// `asked` threads, or as many as there are processors where those are fewer, with what is to be told then. 0 stays, and
/// stands for all of them.
pub fn threads(asked: usize) -> (usize, Option<String>) {
    let there = processors();
    match asked > there {
        true => {
            let told = format!(
                "{asked} threads are asked for, and {there} can run at once here: {there} are used"
            );
            (there, Some(told))
        }
        false => (asked, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_threads_than_processors() {
        let there = processors();
        assert_eq!(threads(0), (0, None));
        assert_eq!(threads(there), (there, None));
        let (used, told) = threads(there + 5);
        assert_eq!(used, there);
        assert!(
            told.is_some_and(|t| t.starts_with(&format!("{} threads are asked for", there + 5)))
        );
    }
}
