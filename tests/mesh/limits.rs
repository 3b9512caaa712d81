//! Mesh files that ask for more than they hold: counts in headers, sets of sets, groups of everything, other files.
use covact::mesh::{MeshError, read_gmsh, read_inp};
use std::fmt::Write;
use std::path::Path;
use std::time::{Duration, Instant};

/// One hexahedron in an input file, with more text after it.
fn inp(more: &str) -> String {
    let mut text = String::from("*NODE\n");
    for n in 0..8 {
        writeln!(text, "{}, {}, {}, {}", n + 1, n & 1, n >> 1 & 1, n >> 2).unwrap();
    }
    text + "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 4, 3, 5, 6, 8, 7\n" + more
}

fn refused(text: &str) -> String {
    let start = Instant::now();
    let error = read_inp(text.as_bytes(), Path::new("a.inp"), 1.0).unwrap_err();
    assert!(
        start.elapsed() < Duration::from_secs(10),
        "{:?}",
        start.elapsed()
    );
    let message = error.to_string();
    assert!(message.len() < 500, "{message}");
    message
}

/// Every set names the one before it ten times: 10^30 members from a kilobyte.
#[test]
fn sets_of_sets_do_not_explode() {
    let mut sets = String::from("*NSET, NSET=S0\n1, 2, 3\n");
    for k in 1..30 {
        writeln!(
            sets,
            "*NSET, NSET=S{k}\n{}",
            format!("S{}, ", k - 1).repeat(10)
        )
        .unwrap();
    }
    let message = refused(&inp(&sets));
    assert!(message.contains("its sets hold more than"), "{message}");
    // Those of elements are without duplicates; many lines of the whole are as long.
    let mut many = String::new();
    for n in 9..2009 {
        writeln!(many, "{n}, 0, 0, {n}").unwrap();
    }
    let all = "*NSET, NSET=ALL, GENERATE\n1, 2008\n";
    let again = "*NSET, NSET=AGAIN\n".to_owned() + &"ALL\n".repeat(1000);
    let message = refused(&inp(&format!("*NODE\n{many}{all}{again}")));
    assert!(
        message.contains("64 for each node and element"),
        "{message}"
    );
    // What people write is far from it.
    let few = "*NSET, NSET=A, GENERATE\n1, 8\n".to_owned() + &"*NSET, NSET=B\nA, A, A\n".repeat(20);
    read_inp(inp(&few).as_bytes(), Path::new("a.inp"), 1.0).unwrap();
}

/// Ranges far beyond all numbers, over and over, beside elements that were passed over.
#[test]
fn ranges_are_not_walked_without_end() {
    let rod = "*ELEMENT, TYPE=T3D2\n77, 1, 2\n";
    let ranges = "1, 18446744073709551615, 2\n".repeat(100_000);
    let text = inp(&format!("{rod}*NSET, NSET=W, GENERATE\n{ranges}"));
    let start = Instant::now();
    let read = read_inp(text.as_bytes(), Path::new("a.inp"), 1.0);
    assert!(
        start.elapsed() < Duration::from_secs(10),
        "{:?}",
        start.elapsed()
    );
    assert!(matches!(read, Err(MeshError::LongSets { .. })), "{read:?}");
}

#[test]
fn no_other_file_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let other = folder.path().join("other.inp");
    std::fs::write(&other, inp("")).unwrap();
    let path = other.display();
    for line in [
        format!("*INCLUDE, INPUT={path}"),
        format!("*Include, input=\"{path}\""),
    ] {
        let message = refused(&inp(&line));
        assert!(
            message.contains("*INCLUDE is not supported: put the included text into this file")
        );
    }
    // Data of a node in a file of their own.
    let message = refused(&format!(
        "*NODE, INPUT={path}\n*ELEMENT, TYPE=C3D8, INPUT={path}\n"
    ));
    println!("{message}");
    assert!(message.contains("INPUT"), "{message}");
    let merge = format!("Merge \"{path}\";\n");
    let error = read_gmsh(merge.as_bytes(), Path::new("a.msh"), 1.0).unwrap_err();
    assert!(
        error.to_string().contains("expected $MeshFormat"),
        "{error}"
    );
}

/// A volume in many thousand groups: each would get all its nodes.
#[test]
fn groups_do_not_multiply_the_mesh() {
    let n = 1000;
    let groups = 20_000;
    let mut text =
        String::from("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 ");
    write!(text, "{groups}").unwrap();
    for g in 0..groups {
        write!(text, " {}", g + 1).unwrap();
    }
    write!(
        text,
        " 0\n$EndEntities\n$Nodes\n1 {} 1 {}\n3 1 0 {}\n",
        4 * n,
        4 * n,
        4 * n
    )
    .unwrap();
    for k in 0..4 * n {
        writeln!(text, "{}", k + 1).unwrap();
    }
    for k in 0..n {
        for c in 0..4 {
            writeln!(text, "{} {} {k}", c & 1, c >> 1).unwrap();
        }
    }
    write!(
        text,
        "$EndNodes\n$Elements\n1 {} 1 {}\n3 1 5 {}\n",
        n - 1,
        n - 1,
        n - 1
    )
    .unwrap();
    for e in 0..n - 1 {
        let a = 4 * e + 1;
        let [b, c, d] = [a + 1, a + 3, a + 2];
        writeln!(
            text,
            "{} {a} {b} {c} {d} {} {} {} {}",
            e + 1,
            a + 4,
            b + 4,
            c + 4,
            d + 4
        )
        .unwrap();
    }
    text += "$EndElements\n";
    let error = read_gmsh(text.as_bytes(), Path::new("a.msh"), 1.0).unwrap_err();
    assert!(matches!(error, MeshError::LongSets { .. }), "{error}");
    let few = text.replacen(&format!(" {groups} "), " 2 ", 1);
    assert!(few != text);
}

/// Numbers in headers that nothing stands behind take no memory: the file is too short for them.
#[test]
fn counts_are_not_trusted() {
    for (section, lines) in [
        ("PhysicalNames", "18446744073709551615\n"),
        ("Entities", "18446744073709551615 0 0 0\n"),
        ("Nodes", "1 18446744073709551615 1 1\n"),
        ("Nodes", "1000000000 1 1 1\n"),
        ("Nodes", "1 1 1 1\n3 1 0 1000000000000\n"),
    ] {
        let text =
            format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n${section}\n{lines}$End{section}\n");
        let error = read_gmsh(text.as_bytes(), Path::new("a.msh"), 1.0).unwrap_err();
        assert!(matches!(error, MeshError::Syntax { .. }), "{error}");
    }
}

/// Names and words of files in messages.
#[test]
fn long_words_are_cut_off() {
    let long = "n".repeat(100_000);
    for more in [
        format!("*NODE, INPUT={long}\n"),
        format!("*NODE, SYSTEM={long}\n"),
        format!("*ELEMENT, TYPE=C3D10{long}\n"),
        format!("*ELEMENT, TYPE=C3D{long}\n"),
        format!("*NSET, NSET={long}\n1\n"),
        format!("*NODE, NSET={long}\n9, 0, 0, 9\n"),
        format!("*SURFACE, NAME={long}\n1, S1\n"),
    ] {
        refused(&inp(&more));
    }
    let many: String = (0..10_000)
        .map(|k| format!("*ELEMENT, TYPE=T{k}\n*K{k}\n"))
        .collect();
    let message = refused(&many);
    assert!(message.contains("and 9980 more"), "{message}");
    let (_, report) = read_inp(inp(&many).as_bytes(), Path::new("a.inp"), 1.0).unwrap();
    assert!(report.notes.iter().all(|n| n.len() < 1000));
    for text in [
        format!(
            "$MeshFormat\n4.1{} 0 8\n$EndMeshFormat\n",
            "0".repeat(100_000)
        ),
        format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n${long}\n"),
        format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"{long}\"\n"),
    ] {
        let error = read_gmsh(text.as_bytes(), Path::new("a.msh"), 1.0).unwrap_err();
        assert!(error.to_string().len() < 500, "{error}");
    }
}

/// Thousands of hexahedra with the same nodes, or with nodes of their own in the same places.
#[test]
fn many_elements_in_one_place() {
    let mut text = inp("");
    let hexahedron = "1, 2, 4, 3, 5, 6, 8, 7";
    for e in 2..20_000 {
        writeln!(text, "{e}, {hexahedron}").unwrap();
    }
    text += "*ELEMENT, TYPE=S4, ELSET=Q\n";
    for e in 20_000..60_000 {
        writeln!(text, "{e}, 1, 2, 4, 3").unwrap();
    }
    let message = refused(&text);
    assert!(message.contains("meet in one face"), "{message}");

    let mut nodes = String::from("*NODE\n");
    let mut elements = String::from("*ELEMENT, TYPE=C3D8\n");
    for e in 0..10_000 {
        let mut own = String::new();
        for k in [0, 1, 3, 2, 4, 5, 7, 6] {
            write!(own, ", {}", 8 * e + k + 1).unwrap();
        }
        for n in 0..8 {
            writeln!(
                nodes,
                "{}, {}, {}, {}",
                8 * e + n + 1,
                n & 1,
                n >> 1 & 1,
                n >> 2
            )
            .unwrap();
        }
        writeln!(elements, "{}{own}", e + 1).unwrap();
    }
    let message = refused(&(nodes + &elements));
    assert!(message.contains("lie at the same place"), "{message}");
}

/// Parts of a partitioned entity have its groups: many of both would be as many as their product.
#[test]
fn parts_share_the_groups_of_their_parent() {
    let n = 50_000;
    let mut text =
        String::from("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 ");
    writeln!(text, "{n}{} 0\n$EndEntities", " 1".repeat(n)).unwrap();
    writeln!(text, "$PartitionedEntities\n1 0\n0 0 0 {n}").unwrap();
    for k in 0..n {
        writeln!(text, "{} 3 1 0 0 0 0 1 1 1 0 0", k + 2).unwrap();
    }
    text += "$EndPartitionedEntities\n";
    let start = Instant::now();
    let error = read_gmsh(text.as_bytes(), Path::new("a.msh"), 1.0).unwrap_err();
    assert!(
        error.to_string().contains("expected a section $Nodes"),
        "{error}"
    );
    assert!(
        start.elapsed() < Duration::from_secs(3),
        "{:?}",
        start.elapsed()
    );
}
