//! The texts of errors, which mark where they mention a setting.

use std::fmt;
use std::ops::{Add, AddAssign, Deref, Range};

use serde::{Serialize, Serializer};

/// Defines the settings from a table: the meaning of each, and its name in the library.
macro_rules! settings {
    ($($(#[$doc:meta])* $setting:ident = $name:literal,)+) => {
        /// A setting of the library that a message mentions. It is [displayed](fmt::Display) by its name in the library; a program that
        /// sets it in another way can substitute its own name, see [`Message::with_names`].
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Setting {
            $($(#[$doc])* $setting,)+
        }

        impl Setting {
            /// All settings.
            pub const ALL: &[Setting] = &[$(Setting::$setting),+];

            /// Its name in the library.
            fn name(self) -> &'static str {
                match self {
                    $(Setting::$setting => $name,)+
                }
            }
        }
    };
}

settings! {
    /// The memory limit.
    MemoryLimit = "`memory_limit`",
    /// Whether files may refer to files outside their folders.
    AllowOutside = "`allow_outside`",
    /// Whether a comparison accepts its pictures in an order that looks swapped.
    AllowSwapped = "`allow_swapped`",
    /// Whether an export replaces an existing one.
    Overwrite = "`overwrite`",
    /// Whether an export includes test vectors.
    Vectors = "`vectors`",
    /// The rendering method.
    Method = "`method`",
    /// The ray tracer as the method, as advice: "trace it with …".
    TraceIt = "trace it with `render::render`",
    /// Leaving out pixels with non-finite radiance from a comparison.
    IgnoreNotFinite = "`NotFinite::Ignore`",
    /// Counting non-finite radiance as a given value in a comparison.
    CountNotFinite = "`NotFinite::CountAs(0.0)`",
    /// Reading a .png that holds linear values: "as …".
    AsLinear = "as `Encoding::Linear`",
    /// The channels to compare.
    Channels = "`channels`",
    /// Comparing radiance alone.
    RadianceAlone = "`channels` of \"radiance\"",
    /// The limit of a metric, followed by its name: "tolerance of …".
    ToleranceOf = "tolerance of",
    /// Texture coordinates made for a bake.
    Atlas = "`Coordinates::Atlas`",
    /// Baking what the camera sees.
    CameraCube = "`camera_cube`",
    /// The number of texels to bake, which follows: "a size of …".
    TexelsOf = "a `size` of",
    /// The bins of a cube to keep, which follow.
    Bins = "`bins`",
    /// Keeping baked light in single precision: "a cube in …".
    SinglePrecision = "a cube in single precision",
    /// The overrides of a scene, as the place of an edit: "on the …".
    Overrides = "list of overrides",
    /// An override of any key: "… KEY=VALUE".
    Set = "set",
    /// The override of the picture size, which follows.
    Size = "camera.size",
    /// The override of the number of samples per pixel, which follows.
    SamplesPerPixel = "display.samples_per_pixel",
    /// The override of the camera's time, which follows.
    Time = "camera.time",
    /// The override of the diagram's view, which follows.
    Frame = "diagram.view",
    /// The override of the frame to which the diagram's view is boosted, which follows.
    BoostTo = "diagram.animation.boost_to",
    /// The override of the diagram's dimensions, which follow.
    Dimensions = "diagram.dimensions",
    /// The override of the exposure, which follows.
    Exposure = "display.exposure",
    /// The override of the radiance shown as white, which follows.
    White = "display.white",
    /// Sending rays through pixel centres.
    PixelCenters = "`pixel_centers`",
    /// The scene that the compared pictures show.
    Scene = "`scene`",
    /// The value that means "no object" in a picture, which follows.
    NoHit = "`set_no_hit`",
    /// The width of time bins in a comparison.
    BinWidth = "`bin_width`",
    /// Leaving ꟻLIP out of a comparison.
    NoFlip = "no `pixels_per_degree`",
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A text that knows which of its words name settings. Built from texts and [`Setting`]s with `+`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Message {
    /// The text with the library's names.
    text: String,
    /// Where they are in it, in order.
    settings: Vec<(Range<usize>, Setting)>,
}

impl Message {
    /// The text with `name` substituted for each setting that it mentions.
    pub fn with_names(&self, name: impl Fn(Setting) -> String) -> String {
        let mut named = String::with_capacity(self.text.len());
        let mut end = 0;
        // Messages are only appended to, so the spans are in order and do not overlap.
        for (span, setting) in &self.settings {
            named += &self.text[end..span.start];
            named += &name(*setting);
            end = span.end;
        }
        named + &self.text[end..]
    }
}

impl Deref for Message {
    type Target = str;

    fn deref(&self) -> &str {
        &self.text
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.text, f)
    }
}

impl Serialize for Message {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.text.serialize(serializer)
    }
}

impl PartialEq<str> for Message {
    fn eq(&self, other: &str) -> bool {
        self.text == other
    }
}

impl PartialEq<&str> for Message {
    fn eq(&self, other: &&str) -> bool {
        self.text == *other
    }
}

impl PartialEq<String> for Message {
    fn eq(&self, other: &String) -> bool {
        self.text == *other
    }
}

impl<T: Into<String>> From<T> for Message {
    fn from(text: T) -> Self {
        Message {
            text: text.into(),
            settings: Vec::new(),
        }
    }
}

impl From<Setting> for Message {
    fn from(setting: Setting) -> Self {
        Message {
            text: setting.to_string(),
            settings: vec![(0..setting.name().len(), setting)],
        }
    }
}

impl<T: Into<Message>> AddAssign<T> for Message {
    fn add_assign(&mut self, more: T) {
        let Message { text, settings } = more.into();
        // Spans count from the start of the whole text; otherwise another name would be put in the wrong place.
        let offset = self.text.len();
        let moved = |(span, setting): (Range<usize>, Setting)| {
            (span.start + offset..span.end + offset, setting)
        };
        self.settings.extend(settings.into_iter().map(moved));
        self.text += &text;
    }
}

impl<T: Into<Message>> Add<T> for Message {
    type Output = Message;

    fn add(mut self, more: T) -> Message {
        self += more;
        self
    }
}

impl<T: Into<Message>> Add<T> for Setting {
    type Output = Message;

    fn add(self, more: T) -> Message {
        Message::from(self) + more
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_take_other_names_where_they_stand_and_nothing_else_does() {
        let message = Message::from("`overwrite` it ")
            + Setting::Overwrite
            + ", or é "
            + (Setting::Atlas + ": " + Setting::Overwrite);
        assert_eq!(
            message,
            "`overwrite` it `overwrite`, or é `Coordinates::Atlas`: `overwrite`"
        );
        let named = message.with_names(|setting| match setting {
            Setting::Overwrite => "--overwrite".into(),
            other => other.to_string(),
        });
        assert_eq!(
            named,
            "`overwrite` it --overwrite, or é `Coordinates::Atlas`: --overwrite"
        );
        assert_eq!(message.with_names(|setting| setting.to_string()), *message);
    }
}
