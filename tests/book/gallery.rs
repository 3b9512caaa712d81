//! Every benchmark of the gallery says what is known of it.
use crate::page::{read, root};

#[test]
fn every_benchmark_has_source_sketch_number_and_command() {
    let page = read(&root().join("docs/gallery.md"));
    let mut count = 0;
    for section in page.split("\n### ").skip(1) {
        // A chapter may end with it.
        let section = section.split("\n## ").next().expect("a section");
        let name = section.lines().next().expect("a heading");
        let sketch = section.contains("```text") || section.contains("![");
        assert!(sketch, "{name}: no sketch or picture");
        let (_, rest) =
            (section.split_once("\nSource: ")).unwrap_or_else(|| panic!("{name}: no source"));
        assert!(
            rest.contains("`cargo ") || rest.contains("`covact "),
            "{name}: no command"
        );
        let told = rest.split("`cargo ").next().expect("what was reached");
        assert!(
            told.contains(|c: char| c.is_ascii_digit()),
            "{name}: no number"
        );
        count += 1;
    }
    assert!(count >= 27, "{count}");
}
