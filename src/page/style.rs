//! Colours and line widths of plots, once for light, once for dark.
//!
//! Series have the colours of Okabe and Ito (Color Universal Design, 2008), which people with any of the usual kinds of
//! colour blindness tell apart; the yellow one is darker, to be seen on white. Phases have the muted scheme of Tol.

/// Colours of plots.
pub(crate) struct Palette {
    pub ground: &'static str,
    pub ink: &'static str,
    pub muted: &'static str,
    pub grid: &'static str,
    pub band: &'static str,
    pub front: &'static str,
    pub series: [&'static str; 8],
    pub phases: [&'static str; 9],
}

pub(crate) const LIGHT: Palette = Palette {
    ground: "#ffffff",
    ink: "#1b1f24",
    muted: "#5a636e",
    grid: "#dfe3e8",
    band: "#e9e4da",
    front: "#b9c0c9",
    series: [
        "#0072b2", "#d55e00", "#009e73", "#b8559a", "#d68f00", "#3a9fd6", "#4a4a4a", "#8a7d00",
    ],
    phases: [
        "#332288", "#44aa99", "#ddaa33", "#cc6677", "#88ccee", "#117733", "#aa4499", "#999933",
        "#b8bec6",
    ],
};

pub(crate) const DARK: Palette = Palette {
    ground: "#14181d",
    ink: "#e4e8ed",
    muted: "#98a3af",
    grid: "#2b323a",
    band: "#332e24",
    front: "#5b6672",
    series: [
        "#4aa8e8", "#f5813c", "#2cc79c", "#e094c8", "#f2b632", "#8ccbf2", "#c9ced4", "#d9cc4a",
    ],
    phases: [
        "#7d70e0", "#4dbdaa", "#ddaa33", "#dd7788", "#99d6f5", "#3aa65c", "#cc70bb", "#b3b352",
        "#5b6672",
    ],
};

/// Names of the colours with their values.
fn named(p: &Palette) -> Vec<(String, &'static str)> {
    let mut out = vec![
        ("ground".to_string(), p.ground),
        ("ink".to_string(), p.ink),
        ("muted".to_string(), p.muted),
        ("grid".to_string(), p.grid),
        ("band".to_string(), p.band),
        ("front".to_string(), p.front),
    ];
    out.extend((p.series.iter().enumerate()).map(|(i, c)| (format!("c{i}"), *c)));
    out.extend((p.phases.iter().enumerate()).map(|(i, c)| (format!("p{i}"), *c)));
    out
}

/// The colours as variables, for a page.
pub(crate) fn variables(p: &Palette) -> String {
    let declare = |(name, value): (String, &str)| format!("--{name}:{value};");
    named(p).into_iter().map(declare).collect()
}

/// The rules of plots with colours as they are, for files that stand alone: some programs that show SVG know no
/// variables.
pub(crate) fn literal_rules(p: &Palette) -> String {
    let mut rules = rules();
    // Longer names first, so that none is taken for the beginning of another.
    let mut colours = named(p);
    colours.sort_by_key(|c| std::cmp::Reverse(c.0.len()));
    for (name, value) in colours {
        rules = rules.replace(&format!("var(--{name})"), value);
    }
    rules
}

/// The rules of plots.
pub(crate) fn rules() -> String {
    let mut out = String::from(
        "\
.plot text{font:12px system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif;fill:var(--ink)}
.plot .title{font-size:14px;font-weight:600}
.plot .soft{fill:var(--muted)}
.plot .small{font-size:11px}
.plot .end{text-anchor:end}
.plot .mid{text-anchor:middle}
.plot .grid{stroke:var(--grid);stroke-width:1;fill:none}
.plot .fine{stroke:var(--grid);stroke-width:.5;fill:none}
.plot .frame{stroke:var(--muted);stroke-width:1;fill:none}
.plot .band{fill:var(--band)}
.plot .front{stroke:var(--front);stroke-width:7;stroke-linejoin:round;stroke-linecap:round;fill:none}
.plot .l{fill:none;stroke:currentColor;stroke-width:1.8;stroke-linejoin:round}
.plot .thin{stroke-width:1;opacity:.6}
.plot .dash{stroke-dasharray:6 4}
.plot .dot{stroke-dasharray:2 2.5}
.plot .long{stroke-dasharray:14 4}
.plot .ref{fill:none;stroke:var(--ink);stroke-width:1.2}
.plot .m{fill:currentColor;stroke:var(--ground);stroke-width:1}
.plot .open .m{fill:var(--ground);stroke:currentColor;stroke-width:1.6}
.plot .e{stroke:currentColor;stroke-width:1.2;fill:none}
.plot .bar{fill:currentColor}
.plot .seg{stroke:var(--ground);stroke-width:.6}
",
    );
    for i in 0..8 {
        out.push_str(&format!(".plot .c{i}{{color:var(--c{i})}}\n"));
    }
    for i in 0..9 {
        out.push_str(&format!(".plot .p{i}{{fill:var(--p{i})}}\n"));
    }
    out
}
