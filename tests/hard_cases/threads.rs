//! The number of threads changes nothing, to the last bit.
use crate::common::{done, plate};
use serde_json::json;

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let history = |threads: u32| {
        // More elements and slave points than any chunk of parallel work holds.
        let mut scene = plate(12, 5.0, 4);
        scene["solution"]["threads"] = json!(threads);
        let outcome = done(&scene);
        // No more than can run at once.
        let used = (threads as usize).min(covact::machine::processors());
        assert_eq!(outcome.summary.threads, used);
        std::fs::read(outcome.folder.path().join("history.csv")).expect("history")
    };
    let one = history(1);
    assert!(one.iter().filter(|b| **b == b'\n').count() > 4);
    for threads in [2, 3] {
        assert!(one == history(threads), "{threads} threads differ");
    }
}
