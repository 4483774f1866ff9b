//! The extensions that a file uses: those it declares, and those that its parts name without a declaration.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fmt;

use serde::de::{DeserializeSeed, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::Deserializer;

/// The extensions that may be required: what this program reads is complete if these are ignored or applied.
pub(super) const UNDERSTOOD: [&str; 11] = [
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_node_visibility",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_materials_transmission",
    "KHR_materials_ior",
    "KHR_materials_volume",
    SPECULAR_GLOSSINESS,
];

/// The extension for materials with a diffuse and a specular colour.
pub(super) const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// Extensions for images that are not read. A file may require them: what needs such an image says so itself.
pub(super) const OF_IMAGES: [&str; 4] = [
    "KHR_texture_basisu",
    "EXT_texture_webp",
    "EXT_texture_avif",
    "MSFT_texture_dds",
];

/// What to do about a file that requires this extension.
pub(super) fn remedy(name: &str) -> &'static str {
    match name {
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
            "decompress it, for example by `gltf-transform copy IN.glb OUT.glb`, or export the model without compression"
        }
        _ => "export the model without it",
    }
}

/// The names in all `extensions` tables of a JSON text, except those in `extras`, which belong to the application.
pub(super) fn named(text: &[u8]) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    let below = Below {
        names: &mut names,
        are_names: false,
    };
    // Invalid JSON is not reported here: reading it as glTF gives the reason.
    let _ = below.deserialize(&mut Deserializer::from_slice(text));
    names
}

/// A value of which only the names of extensions are kept.
struct Below<'n> {
    names: &'n mut BTreeSet<String>,
    /// Whether its keys are names of extensions.
    are_names: bool,
}

impl<'de> DeserializeSeed<'de> for Below<'_> {
    type Value = ();

    fn deserialize<D: serde::Deserializer<'de>>(self, value: D) -> Result<(), D::Error> {
        value.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Below<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_bool<E>(self, _: bool) -> Result<(), E> {
        Ok(())
    }

    fn visit_i64<E>(self, _: i64) -> Result<(), E> {
        Ok(())
    }

    fn visit_u64<E>(self, _: u64) -> Result<(), E> {
        Ok(())
    }

    fn visit_f64<E>(self, _: f64) -> Result<(), E> {
        Ok(())
    }

    fn visit_str<E>(self, _: &str) -> Result<(), E> {
        Ok(())
    }

    fn visit_unit<E>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<(), A::Error> {
        loop {
            let names = &mut *self.names;
            let are_names = false;
            if items
                .next_element_seed(Below { names, are_names })?
                .is_none()
            {
                return Ok(());
            }
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        while let Some(key) = entries.next_key::<Cow<str>>()? {
            if self.are_names {
                self.names.insert(key.to_string());
            } else if key == "extras" {
                entries.next_value::<IgnoredAny>()?;
                continue;
            }
            entries.next_value_seed(Below {
                names: self.names,
                are_names: !self.are_names && key == "extensions",
            })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_tables_of_extensions_at_any_depth() {
        let text = br#"{ "extensions": { "A": { "extensions": { "B": [1, null, true, -2, 0.5] } } },
            "nodes": [{ "extras": { "extensions": { "C": {} } } }, { "extensions": { "D": "extensions", "extras": { "x": 1 } } }],
            "extensionsUsed": ["E"] }"#;
        let names: Vec<String> = named(text).into_iter().collect();
        assert_eq!(names, ["A", "B", "D", "extras"]);
        assert!(named(b"{ \"extensions\": ").is_empty());
    }
}
