//! The texts of errors, which know where they speak of a setting.

use std::fmt;
use std::ops::{Add, AddAssign, Deref, Range};

use serde::{Serialize, Serializer};

/// Makes the settings of a table: of each what it is, and what the library calls it.
macro_rules! settings {
    ($($(#[$doc:meta])* $setting:ident = $name:literal,)+) => {
        /// A setting of the library that a message speaks of. The library calls it as it is called there, which is how it is
        /// [displayed](fmt::Display); a program that sets it in another way can name that, see [`Message::with_names`].
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Setting {
            $($(#[$doc])* $setting,)+
        }

        impl Setting {
            /// All.
            pub const ALL: &[Setting] = &[$(Setting::$setting),+];

            /// What the library calls it.
            fn name(self) -> &'static str {
                match self {
                    $(Setting::$setting => $name,)+
                }
            }
        }
    };
}

settings! {
    /// How much memory may be taken.
    MemoryLimit = "`memory_limit`",
    /// Whether files may refer to others outside their folders.
    AllowOutside = "`allow_outside`",
    /// Whether a comparison takes its pictures in an order that looks swapped.
    AllowSwapped = "`allow_swapped`",
    /// Whether an export replaces another.
    Overwrite = "`overwrite`",
    /// Whether an export has test vectors.
    Vectors = "`vectors`",
    /// The method by which a picture is made.
    Method = "`method`",
    /// The ray tracer as that method, as an advice: "trace it with …".
    TraceIt = "trace it with `render::render`",
    /// That a comparison leaves out pixels whose light is not finite.
    IgnoreNotFinite = "`NotFinite::Ignore`",
    /// That a comparison counts light that is not finite as a value.
    CountNotFinite = "`NotFinite::CountAs(0.0)`",
    /// How a .png that holds linear values is read: "as …".
    AsLinear = "as `Encoding::Linear`",
    /// Which channels are compared.
    Channels = "`channels`",
    /// That nothing but radiance is compared.
    RadianceAlone = "`channels` of \"radiance\"",
    /// The limit of a metric, whose name follows: "tolerance of …".
    ToleranceOf = "tolerance of",
    /// Texture coordinates that are made for what is baked.
    Atlas = "`Coordinates::Atlas`",
    /// Light that is baked by what the camera sees.
    CameraCube = "`camera_cube`",
    /// How many texels are baked, which follow: "a size of …".
    TexelsOf = "a `size` of",
    /// Which bins of a cube are kept, which follow.
    Bins = "`bins`",
    /// That what is baked is kept in single precision: "a cube in …".
    SinglePrecision = "a cube in single precision",
    /// The overrides of a scene, as what an edit is in: "on the …".
    Overrides = "list of overrides",
    /// An override of any key: "… KEY=VALUE".
    Set = "set",
    /// The override of the size of pictures, which follows.
    Size = "camera.size",
    /// The override of the number of samples of a pixel, which follows.
    SamplesPerPixel = "display.samples_per_pixel",
    /// The override of the camera's time, which follows.
    Time = "camera.time",
    /// The override of how bright pictures are shown, which follows.
    Exposure = "display.exposure",
    /// The override of the radiance that is white, which follows.
    White = "display.white",
    /// That rays go through the centres of pixels.
    PixelCenters = "`pixel_centers`",
    /// The scene that compared pictures show.
    Scene = "`scene`",
    /// What stands for no object in a picture, which follows.
    NoHit = "`set_no_hit`",
    /// How wide bins are in which a comparison counts time.
    BinWidth = "`bin_width`",
    /// That a comparison leaves ꟻLIP out.
    NoFlip = "no `pixels_per_degree`",
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A text that knows which of its words name settings. Made from texts and [`Setting`]s, by `+`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Message {
    /// With the library's names.
    text: String,
    /// Where they stand in it, in order.
    settings: Vec<(Range<usize>, Setting)>,
}

impl Message {
    /// The text with `name` for each setting that it speaks of.
    pub fn with_names(&self, name: impl Fn(Setting) -> String) -> String {
        let mut named = String::with_capacity(self.text.len());
        let mut end = 0;
        // Messages grow at their end alone, so that spans are in order and do not overlap.
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
        // Spans count from the start of the whole text, or another name would be put in the wrong place.
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
