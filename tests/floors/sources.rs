//! Reads every path from the root of the crate out of the sources.
use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A use of one top-level module by another.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Arrow {
    pub from: String,
    pub to: String,
    /// Path from the root of the crate, as it is written.
    pub path: String,
    /// `file:line`.
    pub place: String,
}

/// What is read of the sources.
#[derive(Debug, Default)]
pub struct Sources {
    /// Top-level modules.
    pub modules: Vec<String>,
    /// Names at the root of the crate that are no modules, with the module that each comes from.
    names: BTreeMap<String, String>,
    /// Paths from the root: module, path, place.
    paths: Vec<(String, Vec<String>, String)>,
    /// What this test does not understand.
    pub unclear: Vec<String>,
}

/// A file under way.
struct File<'a> {
    sources: &'a mut Sources,
    /// As messages name it.
    name: String,
    /// Folder of the files of its modules; none: they are not read.
    folder: Option<PathBuf>,
}

fn ident(token: Option<&TokenTree>) -> Option<String> {
    match token? {
        TokenTree::Ident(ident) => Some(ident.to_string()),
        _ => None,
    }
}

fn punct(token: Option<&TokenTree>, c: char) -> bool {
    matches!(token, Some(TokenTree::Punct(p)) if p.as_char() == c)
}

fn group(token: Option<&TokenTree>, delimiter: Delimiter) -> Option<&Group> {
    match token? {
        TokenTree::Group(group) if group.delimiter() == delimiter => Some(group),
        _ => None,
    }
}

fn tokens(stream: TokenStream) -> Vec<TokenTree> {
    stream.into_iter().collect()
}

/// Whether `::` stands at a place.
fn colons(tokens: &[TokenTree], at: usize) -> bool {
    punct(tokens.get(at), ':') && punct(tokens.get(at + 1), ':')
}

/// Whether an attribute is `cfg(test)`, alone or in `all(...)`.
fn is_test(attribute: &Group) -> bool {
    let inner = tokens(attribute.stream());
    if ident(inner.first()).as_deref() != Some("cfg") {
        return false;
    }
    let Some(condition) = group(inner.get(1), Delimiter::Parenthesis) else {
        return false;
    };
    let condition = tokens(condition.stream());
    let asks = |tokens: &[TokenTree]| {
        tokens
            .iter()
            .any(|t| ident(Some(t)).as_deref() == Some("test"))
    };
    match ident(condition.first()).as_deref() {
        Some("test") => condition.len() == 1,
        Some("all") => group(condition.get(1), Delimiter::Parenthesis)
            .is_some_and(|all| asks(&tokens(all.stream()))),
        _ => false,
    }
}

/// Place after the item, field or statement that starts at `at`.
fn after_item(tokens: &[TokenTree], at: usize) -> usize {
    const TO_SEMICOLON: [&str; 5] = ["use", "const", "static", "type", "let"];
    const TO_BRACE: [&str; 8] = [
        "fn", "mod", "impl", "struct", "enum", "trait", "unsafe", "extern",
    ];
    let mut kind = None;
    for (i, token) in tokens.iter().enumerate().skip(at) {
        let word = ident(Some(token));
        if let (None, Some(word)) = (kind, word.as_deref()) {
            if TO_SEMICOLON.contains(&word) {
                kind = Some(false);
            } else if TO_BRACE.contains(&word) || word == "macro_rules" {
                kind = Some(true);
            }
        }
        let ends = punct(Some(token), ';')
            || kind == Some(true) && group(Some(token), Delimiter::Brace).is_some()
            || kind.is_none() && punct(Some(token), ',');
        if ends {
            return i + 1;
        }
    }
    tokens.len()
}

impl File<'_> {
    fn place(&self, token: &TokenTree) -> String {
        format!("{}:{}", self.name, token.span().start().line)
    }

    /// Reads what a module holds.
    fn module(&mut self, tokens: &[TokenTree], module: &[String]) {
        let mut exported = false;
        let mut i = 0;
        while i < tokens.len() {
            if punct(tokens.get(i), '#') {
                let inner = punct(tokens.get(i + 1), '!');
                let at = i + 1 + usize::from(inner);
                if let Some(attribute) = group(tokens.get(at), Delimiter::Bracket) {
                    if is_test(attribute) {
                        i = match inner {
                            true => tokens.len(),
                            false => after_item(tokens, at + 1),
                        };
                        continue;
                    }
                    match ident(attribute.stream().into_iter().next().as_ref()).as_deref() {
                        Some("macro_export") => exported = true,
                        Some(word @ ("path" | "macro_use")) => {
                            let text =
                                format!("{}: the attribute `{word}`", self.place(&tokens[i]));
                            self.sources.unclear.push(text);
                        }
                        _ => {}
                    }
                    self.module(&self::tokens(attribute.stream()), module);
                    i = at + 1;
                    continue;
                }
            }
            match ident(tokens.get(i)).as_deref() {
                Some("macro_rules") if exported && punct(tokens.get(i + 1), '!') => {
                    if let (Some(name), Some(from)) = (ident(tokens.get(i + 2)), module.first()) {
                        self.sources.names.insert(name, from.clone());
                    }
                    exported = false;
                }
                Some("mod") => {
                    if let Some(name) = ident(tokens.get(i + 1)) {
                        i += 2 + self.child(tokens.get(i + 2), module, name);
                        continue;
                    }
                }
                Some("use") if module.is_empty() => {
                    let end = after_item(tokens, i);
                    self.root_use(&tokens[i + 1..end]);
                    i = end;
                    continue;
                }
                Some("crate") if colons(tokens, i + 1) => {
                    self.path(tokens, i + 3, &[], Vec::new(), module);
                }
                Some("super" | "self")
                    if colons(tokens, i + 1) && !(i > 1 && colons(tokens, i - 2)) =>
                {
                    self.path(tokens, i, module, Vec::new(), module);
                }
                _ => {}
            }
            if let Some(TokenTree::Group(group)) = tokens.get(i) {
                self.module(&self::tokens(group.stream()), module);
            }
            i += 1;
        }
    }

    /// Reads the module `name`, whose body or semicolon is `body`; how many tokens that was.
    fn child(&mut self, body: Option<&TokenTree>, module: &[String], name: String) -> usize {
        let path = [module, std::slice::from_ref(&name)].concat();
        if module.is_empty() {
            self.sources.modules.push(name.clone());
        }
        if let Some(group) = group(body, Delimiter::Brace) {
            self.module(&tokens(group.stream()), &path);
            return 1;
        }
        if let (true, Some(folder)) = (punct(body, ';'), self.folder.clone()) {
            let file = match folder.join(&name).with_extension("rs") {
                file if file.exists() => file,
                _ => folder.join(&name).join("mod.rs"),
            };
            read_file(self.sources, &file, &folder.join(&name), &path);
        }
        0
    }

    /// What `lib.rs` re-exports is known by its name, or by `as`.
    fn root_use(&mut self, item: &[TokenTree]) {
        let words: Vec<String> = item.iter().filter_map(|t| ident(Some(t))).collect();
        let skip = usize::from(words.first().is_some_and(|w| w == "crate" || w == "self"));
        let Some(from) = words.get(skip).cloned() else {
            return;
        };
        fn leaves(tokens: &[TokenTree], out: &mut Vec<String>) {
            let mut last = None;
            for token in tokens {
                match token {
                    TokenTree::Ident(ident) => last = Some(ident.to_string()),
                    TokenTree::Group(group) => {
                        last = None;
                        leaves(&self::tokens(group.stream()), out);
                    }
                    TokenTree::Punct(p) if p.as_char() == ',' => out.extend(last.take()),
                    TokenTree::Punct(p) if p.as_char() == '*' => out.push("*".to_owned()),
                    _ => {}
                }
            }
            out.extend(last);
        }
        let mut names = Vec::new();
        leaves(item, &mut names);
        for name in names {
            self.sources.names.insert(name, from.clone());
        }
    }

    /// A path that continues at `at` from the module `base`, of which `done` has been read; all branches of a group.
    fn path(
        &mut self,
        tokens: &[TokenTree],
        at: usize,
        base: &[String],
        mut done: Vec<String>,
        module: &[String],
    ) {
        let Some(token) = tokens.get(at) else {
            return;
        };
        match token {
            TokenTree::Ident(word)
                if word == "self" && done.is_empty() && colons(tokens, at + 1) =>
            {
                self.path(tokens, at + 3, base, done, module);
            }
            TokenTree::Ident(word) if word == "super" && done.is_empty() => {
                let above = &base[..base.len().saturating_sub(1)];
                if colons(tokens, at + 1) {
                    self.path(tokens, at + 3, above, done, module);
                }
            }
            TokenTree::Group(group) => {
                let inner = self::tokens(group.stream());
                let mut starts = vec![0];
                starts.extend(
                    (0..inner.len())
                        .filter(|i| punct(inner.get(*i), ','))
                        .map(|i| i + 1),
                );
                for start in starts {
                    self.path(&inner, start, base, done.clone(), module);
                }
            }
            // Inside of a top-level module: no way to another one.
            _ if !base.is_empty() => {}
            TokenTree::Ident(word) => {
                done.push(word.to_string());
                let goes_on = colons(tokens, at + 1) && done.len() < 3;
                let next = tokens.get(at + 3);
                if goes_on && (ident(next).is_some() || matches!(next, Some(TokenTree::Group(_)))) {
                    self.path(tokens, at + 3, base, done, module);
                } else {
                    self.found(token, done, module);
                }
            }
            TokenTree::Punct(p) if p.as_char() == '*' => {
                done.push("*".to_owned());
                self.found(token, done, module);
            }
            _ => {}
        }
    }

    fn found(&mut self, token: &TokenTree, path: Vec<String>, module: &[String]) {
        if let Some(from) = module.first() {
            let place = self.place(token);
            self.sources.paths.push((from.clone(), path, place));
        }
    }
}

pub fn read_file(sources: &mut Sources, file: &Path, folder: &Path, module: &[String]) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let name = file
        .strip_prefix(root)
        .unwrap_or(file)
        .display()
        .to_string();
    let text = match fs::read_to_string(file) {
        Ok(text) => text,
        Err(e) => return sources.unclear.push(format!("{name}: {e}")),
    };
    read_text(sources, &text, name, Some(folder.to_path_buf()), module);
}

pub fn read_text(
    sources: &mut Sources,
    text: &str,
    name: String,
    folder: Option<PathBuf>,
    module: &[String],
) {
    match text.parse::<TokenStream>() {
        Ok(stream) => {
            let mut file = File {
                sources,
                name,
                folder,
            };
            file.module(&tokens(stream), module);
        }
        Err(e) => sources.unclear.push(format!("{name}: {e}")),
    }
}

impl Sources {
    /// The arrows between different modules; what is not understood is left in `unclear`.
    pub fn arrows(&mut self) -> Vec<Arrow> {
        let mut arrows = Vec::new();
        for (from, path, place) in std::mem::take(&mut self.paths) {
            let first = &path[0];
            let to = match self.modules.contains(first) {
                true => Some(first),
                false => self.names.get(first),
            };
            match to {
                None => self.unclear.push(format!(
                    "{place}: `crate::{first}` is no module of src and no name of lib.rs"
                )),
                Some(to) if *to != from => arrows.push(Arrow {
                    from,
                    to: to.clone(),
                    path: path.join("::"),
                    place,
                }),
                Some(_) => {}
            }
        }
        arrows.sort();
        arrows
    }
}
