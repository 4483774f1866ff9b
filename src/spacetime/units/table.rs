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
    /// The power of the speed of light (m/s) that turns base units in seconds into ones in metres.
    pub(super) light: i8,
}

const fn unit(symbol: &'static str, times: f64, over: f64) -> Unit {
    Unit {
        symbol,
        spellings: &[],
        times,
        over,
        light: 0,
    }
}

const fn seconds(symbol: &'static str, over: f64) -> Unit {
    Unit {
        light: 1,
        ..unit(symbol, 1.0, over)
    }
}

/// A unit whose base is 1/s, and becomes 1/m by 1/c.
const fn per_second(symbol: &'static str, times: f64, over: f64) -> Unit {
    Unit {
        light: -1,
        ..unit(symbol, times, over)
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

const INVERSE_LENGTHS: [Unit; 4] = [
    Unit {
        spellings: &["1/m"],
        ..unit("/m", 1.0, 1.0)
    },
    Unit {
        spellings: &["1/cm"],
        ..unit("/cm", 1e2, 1.0)
    },
    Unit {
        spellings: &["1/mm"],
        ..unit("/mm", 1e3, 1.0)
    },
    Unit {
        spellings: &["1/km"],
        ..unit("/km", 1.0, 1e3)
    },
];

/// a/c² is an inverse length: base units are 1/m, the speed of light per second, or m/s².
const ACCELERATIONS: [Unit; 8] = {
    let [m, cm, mm, km] = INVERSE_LENGTHS;
    [
        m,
        cm,
        mm,
        km,
        Unit {
            spellings: &["m/s^2", "m/s²"],
            light: -2,
            ..unit("m/s2", 1.0, 1.0)
        },
        per_second("c/s", 1.0, 1.0),
        per_second("c/ns", 1e9, 1.0),
        per_second("c/ps", 1e12, 1.0),
    ]
};

/// Radians per metre of light path, or per second.
const ANGULAR_RATES: [Unit; 6] = [
    unit("rad/m", 1.0, 1.0),
    Unit {
        spellings: &["°/m"],
        ..unit("deg/m", PI, 180.0)
    },
    per_second("rad/s", 1.0, 1.0),
    Unit {
        spellings: &["°/s"],
        ..per_second("deg/s", PI, 180.0)
    },
    per_second("rad/ns", 1e9, 1.0),
    Unit {
        spellings: &["°/ns"],
        ..per_second("deg/ns", PI * 1e9, 180.0)
    },
];

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
dimension!(
    AccelerationDimension,
    Acceleration,
    "A proper acceleration, as a/c² (/m, /cm, /mm, /km) or a (m/s2, c/s, c/ns, c/ps).",
    "an acceleration",
    ACCELERATIONS
);
dimension!(
    AngularRateDimension,
    AngularRate,
    "An angular rate, over time as optical path length (rad/m, deg/m) or in seconds (rad/s, deg/s, rad/ns, deg/ns).",
    "an angular rate",
    ANGULAR_RATES
);
