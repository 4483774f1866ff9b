//! The library's messages say what to set by the names that it has there; here they become the program's flags.

use nullray::Error;
use nullray::error::Setting;

/// What sets it on the command line, as the words around it go on.
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
        other => return other.to_string(),
    };
    flag.into()
}

/// The same error with flags for the names of fields.
pub fn with_flags(mut error: Error) -> Error {
    if let Error::Invalid(problem) | Error::Unsupported(problem) = &mut error {
        for text in [&mut problem.place, &mut problem.what, &mut problem.help] {
            *text = text.with_names(flag).into();
        }
    }
    error
}

#[cfg(test)]
mod tests {
    use nullray::error::Message;

    use super::*;

    #[test]
    fn fields_of_the_library_become_flags() {
        let help = Message::from("a smaller file, or a higher ") + Setting::MemoryLimit;
        let error = with_flags(Error::invalid("a.glb", "memory", "too large", help));
        assert_eq!(
            error.help(),
            "a smaller file, or a higher limit (--max-memory)"
        );
        let other = "a key of the scene: `channels`";
        assert_eq!(
            with_flags(Error::unsupported("a", "", "", other)).help(),
            other
        );
    }

    #[test]
    fn every_setting_has_a_flag() {
        for setting in Setting::ALL {
            assert!(flag(setting).contains("--"), "{setting}");
        }
    }
}
