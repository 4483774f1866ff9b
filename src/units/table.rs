//! The dimensions and their units: the one table of what may follow a number.

use std::f64::consts::PI;
use std::fmt;

use super::Measure;

/// A unit: its symbol, other spellings of it, and base units per unit as a fraction.
#[derive(Debug, PartialEq)]
pub struct Unit {
    pub(super) symbol: &'static str,
    pub(super) spellings: &'static [&'static str],
    pub(super) times: f64,
    pub(super) over: f64,
    /// Whether base units are seconds (of a [`Time`]) rather than metres.
    pub(super) seconds: bool,
}

const fn unit(symbol: &'static str, times: f64, over: f64) -> Unit {
    Unit {
        symbol,
        spellings: &[],
        times,
        over,
        seconds: false,
    }
}

const fn seconds(symbol: &'static str, over: f64) -> Unit {
    Unit {
        seconds: true,
        ..unit(symbol, 1.0, over)
    }
}

/// Both code points that look like µ.
const MICROMETRE: Unit = Unit {
    spellings: &["µm", "μm"],
    ..unit("um", 1.0, 1e6)
};
const MICROSECOND: Unit = Unit {
    spellings: &["µs", "μs"],
    ..seconds("us", 1e6)
};

const LENGTHS: [Unit; 6] = [
    unit("m", 1.0, 1.0),
    unit("cm", 1.0, 1e2),
    unit("mm", 1.0, 1e3),
    MICROMETRE,
    unit("nm", 1.0, 1e9),
    unit("km", 1e3, 1.0),
];

const TIMES: [Unit; 13] = {
    let [m, cm, mm, um, nm, km] = LENGTHS;
    [
        m,
        cm,
        mm,
        um,
        nm,
        km,
        seconds("ns", 1e9),
        seconds("ps", 1e12),
        seconds("fs", 1e15),
        seconds("as", 1e18),
        MICROSECOND,
        seconds("ms", 1e3),
        seconds("s", 1.0),
    ]
};

/// What a measure measures, and the units that it may have.
pub trait Dimension: Copy + fmt::Debug + PartialEq + 'static {
    /// With its article, for messages: "a time".
    const NAME: &'static str;
    /// The units, the customary one first.
    const UNITS: &'static [Unit];
}

macro_rules! dimension {
    ($marker:ident, $alias:ident, $doc:literal, $name:literal, $units:expr) => {
        #[doc = concat!("Marks ", $name, ".")]
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $marker;

        impl Dimension for $marker {
            const NAME: &'static str = $name;
            const UNITS: &'static [Unit] = &$units;
        }

        #[doc = $doc]
        pub type $alias = Measure<$marker>;
    };
}

dimension!(
    TimeDimension,
    Time,
    "A time, as optical path length (m, cm, mm, um, nm, km) or in seconds (s, ms, us, ns, ps, fs, as).",
    "a time",
    TIMES
);
dimension!(
    LengthDimension,
    Length,
    "A length (m, cm, mm, um, nm, km).",
    "a length",
    LENGTHS
);
dimension!(
    AngleDimension,
    Angle,
    "An angle (deg, rad).",
    "an angle",
    [
        Unit {
            spellings: &["°", "degrees"],
            ..unit("deg", PI, 180.0)
        },
        unit("rad", 1.0, 1.0)
    ]
);
dimension!(
    WavelengthDimension,
    Wavelength,
    "A wavelength (nm, um, mm, cm, m).",
    "a wavelength",
    [
        unit("nm", 1.0, 1e9),
        MICROMETRE,
        unit("mm", 1.0, 1e3),
        unit("cm", 1.0, 1e2),
        unit("m", 1.0, 1.0)
    ]
);
dimension!(
    SpeedDimension,
    Speed,
    "A speed (m/s, km/s, km/h).",
    "a speed",
    [
        unit("m/s", 1.0, 1.0),
        unit("km/s", 1e3, 1.0),
        unit("km/h", 1e3, 3600.0)
    ]
);
dimension!(
    PercentageDimension,
    Percentage,
    "A percentage (%).",
    "a percentage",
    [unit("%", 1.0, 1.0)]
);
