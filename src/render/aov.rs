//! Auxiliary channels: one table of names, meanings and units, from which the command line's help, the files' channel names and the
//! documentation are generated.
//!
//! Identities and barycentric positions (object, primitive, barycentric, uv) are those of the sample nearest to the pixel's centre, and
//! so are a capture's footprint and cosine; the other channels are means over the samples that hit a surface. With one sample per pixel
//! both are that sample's. A pixel that hit nothing holds NaN, and −1 for identities; channels that every pixel has (direction, coverage,
//! alpha, missing data, number of samples, `IndexOB.X`) hold numbers there, too. Values follow the exact physics, whatever effects are
//! turned off for display.

use serde::{Serialize, Serializer};

use crate::error::{Error, Result};

/// Generates the enumeration and its table from one list.
macro_rules! aovs {
    ($($variant:ident, $name:literal, $combine:ident $(($why:ident))?, $meaning:literal, $definition:literal;)*) => {
        /// One auxiliary channel.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Aov {
            $(#[doc = $meaning] $variant,)*
        }

        impl Aov {
            /// All channels, in order.
            pub const ALL: &[Aov] = &[$(Aov::$variant,)*];

            /// The channel's name in files.
            pub fn name(self) -> &'static str {
                match self {
                    $(Aov::$variant => $name,)*
                }
            }

            /// Meaning, with unit and frame.
            pub fn meaning(self) -> &'static str {
                match self {
                    $(Aov::$variant => $meaning,)*
                }
            }

            /// The formula of one ray's value; [`crate::validate::export`] explains the symbols.
            pub fn definition(self) -> &'static str {
                match self {
                    $(Aov::$variant => $definition,)*
                }
            }

            /// How a pixel's value is computed from its samples.
            pub(crate) fn combine(self) -> Combine {
                match self {
                    $(Aov::$variant => Combine::$combine $((Why::$why))?,)*
                }
            }
        }
    };
}

/// How a pixel's value is computed from its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Combine {
    /// An integer, from the sample nearest to the pixel's centre; −1 if that hit nothing.
    NearestIdentity,
    /// The value of the sample nearest to the pixel's centre; NaN if that hit nothing.
    Nearest,
    /// The mean over the samples that hit a surface.
    MeanOfHits,
    /// The mean over all samples.
    MeanOfAll,
    /// The mean over the samples at which the film sees anything; NaN if there are none.
    MeanOfSeeing,
    /// From the film: the known fraction of the radiance.
    Coverage,
    /// From the film: the standard error of the radiance.
    StandardError,
    /// From the film: the number of samples in the mean radiance.
    Samples,
    /// From the film: the fraction of the radiance that is missing for one reason.
    Missing(Why),
}

/// Why radiance is missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Why {
    /// Its light left before the first bin.
    Before,
    /// Its light left after the last bin.
    After,
    /// It is beyond the texture, or the capture camera's image.
    OffTexture,
    /// The capture camera did not see it.
    Occluded,
}

aovs! {
    Object, "object", NearestIdentity, "index of the object in the scene file, −1 where nothing is hit",
        "k, the object with a triangle that the ray X(s) hits at the smallest s > 0";
    Primitive, "primitive", NearestIdentity, "index of the triangle in the object, in the order of its file",
        "index of that triangle, (a, b, c), in the order of the object's geometry";
    BarycentricU, "barycentric.u", Nearest, "weight of the triangle's second corner",
        "u of p = (1 − u − v) a + u b + v c, p the position of object_event";
    BarycentricV, "barycentric.v", Nearest, "weight of the triangle's third corner",
        "v of p = (1 − u − v) a + u b + v c";
    UvU, "uv.u", Nearest, "texture coordinate u (set 0)",
        "first component of (1 − u − v) t_a + u t_b + v t_c, t the corners' TEXCOORD_0";
    UvV, "uv.v", Nearest, "texture coordinate v (set 0), 0 at the top row",
        "second component of (1 − u − v) t_a + u t_b + v t_c";
    EventCt, "event.ct", MeanOfHits, "emission event: world time × c, metres",
        "time of E = X(s) = P + s (−η, d)";
    EventX, "event.x", MeanOfHits, "emission event: world x, metres",
        "x of E = X(s) = P + s (−η, d)";
    EventY, "event.y", MeanOfHits, "emission event: world y, metres",
        "y of E = X(s) = P + s (−η, d)";
    EventZ, "event.z", MeanOfHits, "emission event: world z, metres",
        "z of E = X(s) = P + s (−η, d)";
    ObjectEventCt, "object_event.ct", MeanOfHits, "emission event: the object's own time × c, metres",
        "time of M_k⁻¹ (E − O_k)";
    ObjectEventX, "object_event.x", MeanOfHits, "emission event: object x, metres",
        "x of M_k⁻¹ (E − O_k)";
    ObjectEventY, "object_event.y", MeanOfHits, "emission event: object y, metres",
        "y of M_k⁻¹ (E − O_k)";
    ObjectEventZ, "object_event.z", MeanOfHits, "emission event: object z, metres",
        "z of M_k⁻¹ (E − O_k)";
    DirectionX, "direction.x", MeanOfSeeing, "look direction in the world, x",
        "x of d, where L (−1, d′) = W₀ (−1, d)";
    DirectionY, "direction.y", MeanOfSeeing, "look direction in the world, y",
        "y of d, where L (−1, d′) = W₀ (−1, d)";
    DirectionZ, "direction.z", MeanOfSeeing, "look direction in the world, z",
        "z of d, where L (−1, d′) = W₀ (−1, d)";
    Distance, "distance", MeanOfHits, "world distance from the pinhole event to the emission event, metres",
        "s of E = P + s (−η, d)";
    WavelengthRatio, "wavelength_ratio", MeanOfHits, "observed / emitted wavelength",
        "W = (κ·u_k)/(κ·u_camera), κ = (−1, d), u the four-velocities (W₀ (κ·u_k) of an `unaberrated` camera), a·b = a_x b_x + a_y b_y + a_z b_z − a_ct b_ct";
    NormalX, "normal.x", MeanOfHits, "geometric normal in the object's rest frame, x",
        "x of (b − a) × (c − a), normalised";
    NormalY, "normal.y", MeanOfHits, "geometric normal in the object's rest frame, y",
        "y of (b − a) × (c − a), normalised";
    NormalZ, "normal.z", MeanOfHits, "geometric normal in the object's rest frame, z",
        "z of (b − a) × (c − a), normalised";
    Coverage, "coverage", Coverage, "fraction of the pixel whose radiance is known, 0 to 1",
        "1 where the source has data at (E, surface point) or none is needed, else 0 or the fraction that it has";
    MissingBefore, "missing.before", Missing(Before), "fraction of the pixel whose light left before its data begin, 0 to 1",
        "fraction of the samples whose time of lookup is before the first bin";
    MissingAfter, "missing.after", Missing(After), "fraction of the pixel whose light left after its data end, 0 to 1",
        "fraction of the samples whose time of lookup is after the last bin";
    MissingOffTexture, "missing.off_texture", Missing(OffTexture), "fraction of the pixel that lies beyond the texture or the capture camera's image, 0 to 1",
        "fraction of the samples with texture coordinates outside [0, 1], or outside the capture camera's image";
    MissingOccluded, "missing.occluded", Missing(Occluded), "fraction of the pixel that the capture camera did not see, 0 to 1",
        "fraction of the samples not seen by any neighbouring pixel of the capture camera's image, or hidden from it";
    CaptureFootprint, "capture.footprint", Nearest, "width on the surface, along its tilt, of a capture camera pixel, metres",
        "width of a pixel at the point's depth, over the cosine between the normal and the direction to the capture camera";
    CaptureCosine, "capture.cosine", Nearest, "cosine between the normal and the direction to the capture camera: near 0 at grazing angles",
        "n·(eye − p) over the length of eye − p, n the normal on the visible side";
    CaptureSource, "capture.source", NearestIdentity, "index in the scene file of the capture that gives most of the radiance, −1 where no capture contains the point",
        "the capture of largest s e (cos θ / a)⁴ of those that saw the point at that time, or the first of them";
    Alpha, "alpha", MeanOfAll, "fraction of the pixel that shows an object, 0 to 1",
        "fraction of the samples that hit an object";
    ObjectId, "IndexOB.X", Nearest, "index of the object plus 1, 0 where nothing is hit: an ID pass, as compositors read it",
        "k + 1, or 0";
    StandardError, "standard_error", StandardError, "standard error of the pixel's mean radiance (mean of R, G, B), from independent parts of its samples and of those of 5 × 5 pixels; above 1 sample per pixel",
        "√(((R − 1) s² + 4 n)/((R + 3) R)), s² = Σ (m_k − m)²/(R − 1), m_k the mean (R + G + B)/3 of part k of R = 8 or more equal parts of the samples, m their mean, and n the mean of s² over 5 × 5 pixels of a tile of 16 × 16, the pixel itself in place of those beyond its edge";
    Samples, "samples", Samples, "number of samples in the mean radiance of the pixel",
        "number of rays";
}

impl Aov {
    /// The channel with this name in files.
    pub fn named(name: &str) -> Option<Aov> {
        Aov::ALL.iter().copied().find(|aov| aov.name() == name)
    }

    /// Whether the channel holds integers.
    pub(crate) fn is_identity(self) -> bool {
        self.combine() == Combine::NearestIdentity
    }
}

/// The channels in a comma-separated list of channels ("event.ct"), groups ("event") or "all". The radiance is always written, so
/// "radiance" adds nothing.
///
/// # Errors
/// An [`Error::Value`] that names the unknown word and the known ones.
pub fn parse(list: &str) -> Result<Vec<Aov>> {
    let mut chosen = Vec::new();
    for word in list.split(',').map(str::trim).filter(|w| !w.is_empty()) {
        let named = named(word);
        if named.is_empty() && word != "radiance" {
            let known = groups().join(", ");
            let what = format!("\"{word}\" is not a channel; there are: all, {known}");
            return Err(Error::Value(what.into()));
        }
        chosen.extend(named);
    }
    // In the order of the table, each once, whatever the list's order.
    let all = Aov::ALL.iter().copied();
    Ok(all.filter(|aov| chosen.contains(aov)).collect())
}

fn named(word: &str) -> Vec<Aov> {
    let is_named = |name: &str| word == "all" || name == word || group(name) == word;
    let all = Aov::ALL.iter().copied();
    all.filter(|aov| is_named(aov.name())).collect()
}

/// The group of the channel of this name.
pub(crate) fn group(name: &str) -> &str {
    name.split('.').next().unwrap_or(name)
}

/// The channels of the group of this name, in order; a channel without a dot is a group by itself.
pub(crate) fn group_of(name: &str) -> Vec<Aov> {
    let all = Aov::ALL.iter().copied();
    all.filter(|aov| group(aov.name()) == name).collect()
}

/// The names of all groups, in order.
pub fn groups() -> Vec<&'static str> {
    let mut groups: Vec<_> = Aov::ALL.iter().map(|aov| group(aov.name())).collect();
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
    fn groups_channels_and_all_are_understood() {
        assert_eq!(parse("event").unwrap().len(), 4);
        assert_eq!(
            parse("object, event.ct,object").unwrap(),
            [Aov::Object, Aov::EventCt]
        );
        assert_eq!(parse("all").unwrap().len(), Aov::ALL.len());
        assert_eq!(parse("radiance").unwrap(), []);
        assert_eq!(parse("missing").unwrap().len(), 4);
        assert!(parse("depth").unwrap_err().to_string().contains("depth"));
    }
}
