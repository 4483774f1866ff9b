//! Replaces the library's names of settings in messages by the program's flags.

use nullray::Error;
use nullray::error::{Message, Problem, Setting};
use nullray::validate::compare::{Breach, Comparison, Measured};

/// The flag that sets it, worded to fit the message.
fn flag(setting: Setting) -> String {
    let flag = match setting {
        Setting::MemoryLimit => "limit (--max-memory)",
        Setting::AllowOutside => "--allow-outside",
        Setting::AllowSwapped => "--allow-swapped",
        Setting::Overwrite => "--overwrite",
        Setting::Vectors => "--vectors",
        Setting::Method => "--method",
        Setting::TraceIt => "render it by --method trace",
        Setting::IgnoreNotFinite => "--nan ignore",
        Setting::CountNotFinite => "--nan count-as=0",
        Setting::AsLinear => "with --transfer linear",
        Setting::Channels => "--channels",
        Setting::RadianceAlone => "--channels radiance",
        Setting::ToleranceOf => "--tolerance",
        Setting::Atlas => "--atlas",
        Setting::CameraCube => "--camera",
        Setting::TexelsOf => "--texels",
        Setting::Bins => "--bins",
        Setting::SinglePrecision => "leave --half out",
        Setting::Overrides => "command line",
        Setting::Set => "--set",
        Setting::Size => "--size",
        Setting::SamplesPerPixel => "--spp",
        Setting::Time => "--time",
        Setting::Frame => "--frame",
        Setting::BoostTo => "--boost-to",
        Setting::Dimensions => "--dimensions",
        Setting::Exposure => "--exposure",
        Setting::White => "--white",
        Setting::PixelCenters => "--pixel-centers",
        Setting::Scene => "--scene",
        Setting::NoHit => "--no-hit",
        Setting::BinWidth => "--bin-width",
        Setting::NoFlip => "--no-flip",
        other => return other.to_string(),
    };
    flag.into()
}

/// The message with flags in place of field names.
pub fn with_flags(message: &Message) -> String {
    message.with_names(flag)
}

/// The same error, with flags in its message.
pub fn of_error(mut error: Error) -> Error {
    if let Error::Invalid(problem) | Error::Unsupported(problem) = &mut error {
        let Problem {
            file,
            place,
            what,
            help,
            ..
        } = &mut **problem;
        for text in [file, place, what, help] {
            *text = with_flags(text).into();
        }
    }
    error
}

/// The same comparison, with flags in its messages.
pub fn of_comparison(mut comparison: Comparison) -> Comparison {
    let diagnoses = comparison.diagnoses.iter_mut().map(|found| &mut found.what);
    for text in comparison.notes.iter_mut().chain(diagnoses) {
        *text = with_flags(text).into();
    }
    comparison
}

/// The same limit, with flags in its message.
pub fn of_breach(mut breach: Breach) -> Breach {
    if let Measured::Nothing(why) = &mut breach.found {
        *why = with_flags(why).into();
    }
    breach
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_of_the_library_become_flags() {
        let help = Message::from("a smaller file, or a higher ") + Setting::MemoryLimit;
        let error = of_error(Error::invalid("a.glb", "memory", "too large", help));
        assert_eq!(
            error.help(),
            "a smaller file, or a higher limit (--max-memory)"
        );
        let other = "a key of the scene: `channels`";
        assert_eq!(
            of_error(Error::unsupported("a", "", "", other)).help(),
            other
        );
    }

    #[test]
    fn every_setting_has_a_flag() {
        for setting in Setting::ALL {
            assert_ne!(flag(*setting), setting.to_string());
        }
    }
}
