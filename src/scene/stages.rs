//! What the stages of a scene say of the run: when each goes on, and which contacts act in it.
use super::types::{Release, Scene, Stage};
use std::collections::BTreeSet;

impl Scene {
    /// Times from which to which stage `index` goes; the whole run where the scene has no stages.
    pub fn stage_span(&self, index: usize) -> [f64; 2] {
        let end = self.solution.end_time;
        let until = |stage: Option<&Stage>| stage.and_then(|s| s.until);
        let from = match index.checked_sub(1) {
            Some(before) => until(self.stages.get(before)).unwrap_or(end),
            None => 0.0,
        };
        [from, until(self.stages.get(index)).unwrap_or(end)]
    }

    /// Contacts that act in stage `index` and, where stages follow, at its end.
    fn lasting(&self, index: usize) -> BTreeSet<&str> {
        let Some(stage) = self.stages.get(index) else {
            return BTreeSet::new();
        };
        match (&stage.contacts, index) {
            (Some(names), _) => names.iter().collect(),
            (None, 0) => self.contacts.keys().map(String::as_str).collect(),
            (None, _) if stage.release.is_some() => BTreeSet::new(),
            (None, _) => self.lasting(index - 1),
        }
    }

    /// Contacts that acted in the stage before and that stage `index` ends.
    pub fn ending_contacts(&self, index: usize) -> BTreeSet<&str> {
        let Some(before) = index.checked_sub(1) else {
            return BTreeSet::new();
        };
        let lasting = self.lasting(index);
        let mut ending = self.lasting(before);
        ending.retain(|name| !lasting.contains(name));
        ending
    }

    /// Contacts that act in stage `index`; all of them where the scene has no stages. Contacts whose tools go back act until the
    /// end of that stage.
    pub fn active_contacts(&self, index: usize) -> BTreeSet<&str> {
        if self.stages.is_empty() {
            return self.contacts.keys().map(String::as_str).collect();
        }
        let mut active = self.lasting(index);
        if self.stages.get(index).and_then(|s| s.release) == Some(Release::Tools) {
            active.extend(self.ending_contacts(index));
        }
        active
    }

    /// Whether a stage releases a contact: what matters is then the shape that a body has taken, plastic strains included.
    pub fn releases(&self, contact: &str) -> bool {
        let releases = |k: &usize| {
            self.stages[*k].release.is_some() && self.ending_contacts(*k).contains(contact)
        };
        (1..self.stages.len()).any(|k| releases(&k))
    }

    /// Rigid surfaces that go back in stage `index`.
    pub fn returning_tools(&self, index: usize) -> BTreeSet<&str> {
        let back = self.stages.get(index).and_then(|s| s.release) == Some(Release::Tools);
        let ending = match back {
            true => self.ending_contacts(index),
            false => BTreeSet::new(),
        };
        let master = |name: &str| self.contacts.get(name).map(|c| c.master.single());
        (ending.into_iter().filter_map(master))
            .filter(|master| self.surfaces.contains_key(*master))
            .collect()
    }

    /// What happens in a stage, in a few words: when it ends, and how contacts end with it.
    pub fn stage_in_words(&self, index: usize) -> String {
        let Some(stage) = self.stages.get(index) else {
            return String::new();
        };
        let ending: Vec<String> = (self.ending_contacts(index).iter())
            .map(|name| format!("`{name}`"))
            .collect();
        let how = match (stage.release, ending.is_empty()) {
            (_, true) => String::new(),
            (Some(Release::Tools), _) => format!(" (the tools of {} go back)", ending.join(", ")),
            _ => format!(" (the forces of {} are let down)", ending.join(", ")),
        };
        format!("`{}` until {}{how}", stage.name, self.stage_span(index)[1])
    }

    /// Whether any stage has supports that the program finds.
    pub fn finds_supports(&self) -> bool {
        self.stages.iter().any(Stage::finds_supports)
    }
}
