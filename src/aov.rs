//! Auxiliary channels: one table of names, meanings and units, from which the command line's help,
//! the files' channel names and the documentation are made.
//!
//! Identities and places on a triangle (object, primitive, barycentric, uv) are those of the sample
//! nearest to the pixel's centre; the other channels are means over the samples that met a surface.
//! With one sample per pixel both are that sample's. A pixel that met nothing holds NaN, and −1 for
//! identities. Values are those of the physics whatever effects are turned off for display.

use serde::{Serialize, Serializer};

/// Makes the enumeration and its table from one list.
macro_rules! aovs {
    ($($variant:ident, $name:literal, $meaning:literal;)*) => {
        /// One auxiliary channel.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Aov {
            $(#[doc = $meaning] $variant,)*
        }

        /// Channel, name, meaning with unit and frame; in the order of [`Aov`].
        pub const TABLE: &[(Aov, &str, &str)] = &[$((Aov::$variant, $name, $meaning),)*];
    };
}

aovs! {
    Object, "object", "index of the object in the scene file, −1 where nothing is met";
    Primitive, "primitive", "index of the triangle in the object, in the order of its file";
    BarycentricU, "barycentric.u", "weight of the triangle's second corner";
    BarycentricV, "barycentric.v", "weight of the triangle's third corner";
    UvU, "uv.u", "texture coordinate u (set 0)";
    UvV, "uv.v", "texture coordinate v (set 0), 0 at the top row";
    EventCt, "event.ct", "emission event: world time × c, metres";
    EventX, "event.x", "emission event: world x, metres";
    EventY, "event.y", "emission event: world y, metres";
    EventZ, "event.z", "emission event: world z, metres";
    ObjectEventCt, "object_event.ct", "emission event: the object's own time × c, metres";
    ObjectEventX, "object_event.x", "emission event: object x, metres";
    ObjectEventY, "object_event.y", "emission event: object y, metres";
    ObjectEventZ, "object_event.z", "emission event: object z, metres";
    DirectionX, "direction.x", "look direction in the world, x";
    DirectionY, "direction.y", "look direction in the world, y";
    DirectionZ, "direction.z", "look direction in the world, z";
    Distance, "distance", "world distance from the pinhole event to the emission event, metres";
    WavelengthRatio, "wavelength_ratio", "observed / emitted wavelength";
    NormalX, "normal.x", "geometric normal in the object's rest frame, x";
    NormalY, "normal.y", "geometric normal in the object's rest frame, y";
    NormalZ, "normal.z", "geometric normal in the object's rest frame, z";
    Coverage, "coverage", "part of the pixel whose radiance is known, 0 to 1";
    StandardError, "standard_error", "estimated standard error of the pixel's mean radiance (mean of R, G, B), above 1 sample per pixel";
}

impl Aov {
    /// The channel's name in files.
    pub fn name(self) -> &'static str {
        self.row().1
    }

    /// Meaning, with unit and frame.
    pub fn meaning(self) -> &'static str {
        self.row().2
    }

    fn row(self) -> &'static (Aov, &'static str, &'static str) {
        &TABLE[self as usize]
    }

    /// Whether the channel belongs to one sample rather than to the mean of all.
    pub fn is_of_one_sample(self) -> bool {
        self <= Aov::UvV
    }

    /// Whether the channel holds integers.
    pub fn is_identity(self) -> bool {
        matches!(self, Aov::Object | Aov::Primitive)
    }
}

/// The channels that a comma-separated list names: channels ("event.ct"), groups ("event") or "all".
/// The radiance is always written, so "radiance" names nothing more.
pub fn parse(list: &str) -> Result<Vec<Aov>, String> {
    let mut chosen: Vec<Aov> = Vec::new();
    for word in list.split(',').map(str::trim).filter(|w| !w.is_empty()) {
        let named = named(word);
        if named.is_empty() && word != "radiance" {
            return Err(format!(
                "\"{word}\" is not a channel; there are: all, {}",
                groups().join(", ")
            ));
        }
        chosen.extend(named);
    }
    chosen.sort_unstable();
    chosen.dedup();
    Ok(chosen)
}

fn named(word: &str) -> Vec<Aov> {
    let is_named = |name: &str| word == "all" || name == word || group(name) == word;
    TABLE
        .iter()
        .filter(|row| is_named(row.1))
        .map(|row| row.0)
        .collect()
}

fn group(name: &str) -> &str {
    name.split('.').next().unwrap_or(name)
}

/// The names of all groups, in the order of the table.
pub fn groups() -> Vec<&'static str> {
    let mut groups: Vec<_> = TABLE.iter().map(|row| group(row.1)).collect();
    groups.dedup();
    groups.push("radiance");
    groups
}

impl Serialize for Aov {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_enumeration() {
        for (i, (aov, _, _)) in TABLE.iter().enumerate() {
            assert_eq!(*aov as usize, i);
        }
    }

    #[test]
    fn groups_channels_and_all_are_understood() {
        assert_eq!(parse("event").unwrap().len(), 4);
        assert_eq!(
            parse("object, event.ct,object").unwrap(),
            [Aov::Object, Aov::EventCt]
        );
        assert_eq!(parse("all").unwrap().len(), TABLE.len());
        assert_eq!(parse("radiance").unwrap(), []);
        assert!(parse("depth").unwrap_err().contains("depth"));
    }
}
