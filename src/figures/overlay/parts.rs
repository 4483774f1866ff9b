//! The parts of an overlay: one table, from which help and messages are made.

use crate::render::aov::Aov;

/// A part of an overlay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Lines of equal retarded time.
    Isochrones,
    /// Apparent and instantaneous outlines of objects.
    Outlines,
    /// The camera's direction of motion.
    Beta,
    /// The legend.
    Legend,
}

/// Parts and their names.
const TABLE: [(Part, &str); 4] = [
    (Part::Isochrones, "isochrones"),
    (Part::Outlines, "outlines"),
    (Part::Beta, "beta"),
    (Part::Legend, "legend"),
];

/// Some of the parts of an overlay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parts([bool; 4]);

impl Default for Parts {
    /// All of them.
    fn default() -> Self {
        Parts([true; 4])
    }
}

impl From<Part> for Parts {
    /// A single part.
    fn from(part: Part) -> Self {
        let mut parts = Parts([false; 4]);
        parts.0[part as usize] = true;
        parts
    }
}

impl Parts {
    /// The parts that a comma-separated list names: "outlines,beta".
    ///
    /// # Errors
    /// An unknown name, or a list without names; the message lists the known names.
    pub fn parse(list: &str) -> Result<Parts, String> {
        let mut parts = Parts([false; 4]);
        for word in list.split(',').map(str::trim).filter(|w| !w.is_empty()) {
            let Some((part, _)) = TABLE.iter().find(|(_, name)| *name == word) else {
                return Err(format!(
                    "\"{word}\" is not a part of an overlay; there are: {}",
                    names()
                ));
            };
            parts.0[*part as usize] = true;
        }
        match parts.0.contains(&true) {
            true => Ok(parts),
            false => Err(format!("name at least one part: {}", names())),
        }
    }

    /// Whether `part` is one of them.
    pub fn has(self, part: Part) -> bool {
        self.0[part as usize]
    }

    /// The auxiliary channels that a film needs for them.
    pub fn needs(self) -> Vec<Aov> {
        let needs = [
            (Part::Isochrones, Aov::EventCt),
            (Part::Outlines, Aov::Object),
        ];
        let needed = needs.into_iter().filter(|(part, _)| self.has(*part));
        needed.map(|(_, aov)| aov).collect()
    }
}

fn names() -> String {
    TABLE.map(|(_, name)| name).join(", ")
}
