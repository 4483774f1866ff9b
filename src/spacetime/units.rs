//! Quantities with units, as used in scene files and on the command line.
//!
//! Inside, all times are ct in metres and all angles radians, as plain `f64`. Outside, every quantity is text with its unit: `"2 ps"`,
//! `"0.6 m"`, `"60 deg"`. A number without a unit is refused.
//!
//! A time may be given in seconds or, as optical path length, in metres: Δ(ct) = c Δt with the speed of light *of the scene*. Conversion
//! therefore waits until that is known ([`Time::metres`]).
//!
//! Decimal units are applied as one correctly rounded multiplication or division: "12 cm" is the f64 nearest to 0.12.

use std::f64::consts::PI;
use std::fmt;
use std::marker::PhantomData;
use std::str::FromStr;

/// The largest accepted magnitude of a number, in base units. The observable universe is 9·10²⁶ m wide; products of four such numbers
/// still fit f64.
pub const LARGEST: f64 = 1e30;
/// The smallest accepted positive number: powers of smaller ones leave f64's range.
pub const SMALLEST: f64 = 1e-30;

/// A finite number and its unit, as written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure<D> {
    number: f64,
    unit: &'static Unit,
    dimension: PhantomData<D>,
}

/// Why a text is not a valid measure, and what would be right.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct UnitError(String);

crate::error::value_errors!(UnitError);

impl<D: Dimension> Measure<D> {
    /// `number` in the dimension's customary unit: metres, degrees, nanometres, K, m/s, %, /m, rad/m.
    pub const fn customary(number: f64) -> Self {
        Measure {
            number,
            unit: &D::UNITS[0],
            dimension: PhantomData,
        }
    }

    /// This measure times `factor`, to four digits, in the same unit: a bound to name in a message.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        let product = self.number * factor;
        // Via its text, so that it prints without further digits.
        let number = format!("{product:.3e}").parse().unwrap_or(product);
        Measure { number, ..self }
    }

    /// The value in base units, with seconds converted to metres by the speed of light `c` in metres per second.
    fn with_light(self, c: f64) -> f64 {
        let base = self.base();
        match self.unit.light {
            1 => base * c,
            -1 => base / c,
            -2 => base / c / c,
            _ => base,
        }
    }

    /// The value in base units: metres, radians, m/s, per cent; seconds in the unit stay seconds.
    fn base(self) -> f64 {
        // One rounding if one is enough: "12 cm" is the f64 nearest to 0.12.
        if self.unit.times == 1.0 {
            self.number / self.unit.over
        } else {
            self.number * self.unit.times / self.unit.over
        }
    }

    /// The symbols of all units, for messages: "m, cm or mm".
    pub fn units() -> String {
        let symbols: Vec<&str> = D::UNITS.iter().map(|unit| unit.symbol).collect();
        match symbols.split_last() {
            Some((last, [])) => (*last).to_string(),
            Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
            None => String::new(),
        }
    }

    /// All spellings of all units.
    #[cfg(feature = "schema")]
    pub(crate) fn spellings() -> impl Iterator<Item = &'static str> {
        D::UNITS
            .iter()
            .flat_map(|unit| std::iter::once(unit.symbol).chain(unit.spellings.iter().copied()))
    }

    /// The error for `number` without a unit, and what would be right.
    pub(crate) fn without_unit(number: impl fmt::Display) -> UnitError {
        let (name, symbol, units) = (D::NAME, D::UNITS[0].symbol, Self::units());
        UnitError(format!(
            "the number {number} has no unit: {name} is a text like \"{number} {symbol}\" (units: {units})"
        ))
    }
}

impl Time {
    /// ct in metres, with the speed of light `c` in metres per second.
    pub fn metres(self, c: f64) -> f64 {
        self.with_light(c)
    }
}

impl Acceleration {
    /// a/c² in 1/m, for the speed of light `c` in metres per second.
    pub fn per_metre(self, c: f64) -> f64 {
        self.with_light(c)
    }
}

impl AngularRate {
    /// Ω/c in radians per metre, for the speed of light `c` in metres per second.
    pub fn radians_per_metre(self, c: f64) -> f64 {
        self.with_light(c)
    }
}

impl Length {
    /// In metres.
    pub fn metres(self) -> f64 {
        self.base()
    }
}

impl Angle {
    /// In radians.
    pub fn radians(self) -> f64 {
        self.base()
    }

    /// An angle of `radians`, in degrees with the fewest digits that give it, from 12 on: "50 deg", where conversion alone rounds to
    /// 49.999999999999986.
    pub fn of_radians(radians: f64) -> Angle {
        let exact = radians.to_degrees();
        let with_digits = |digits: usize| format!("{exact:.*e}", digits - 1).parse().ok();
        let mut short = (12..17).filter_map(with_digits).map(Angle::customary);
        let angle = short.find(|angle| angle.radians() == radians);
        angle.unwrap_or(Angle::customary(exact))
    }

    /// Sine and cosine; exact at multiples of 90 degrees.
    pub fn sin_cos(self) -> (f64, f64) {
        // The first unit is the degree.
        if self.unit == &AngleDimension::UNITS[0] && self.number % 90.0 == 0.0 {
            return match (self.number / 90.0).rem_euclid(4.0) {
                1.0 => (1.0, 0.0),
                2.0 => (0.0, -1.0),
                3.0 => (-1.0, 0.0),
                _ => (0.0, 1.0),
            };
        }
        libm::sincos(self.radians())
    }
}

impl Wavelength {
    /// In metres.
    pub fn metres(self) -> f64 {
        self.base()
    }
}

impl Temperature {
    /// In kelvin.
    pub fn kelvin(self) -> f64 {
        self.base()
    }
}

impl Speed {
    /// In metres per second.
    pub fn metres_per_second(self) -> f64 {
        self.base()
    }
}

impl Percentage {
    /// In per cent.
    pub fn percent(self) -> f64 {
        self.base()
    }
}

impl<D> fmt::Display for Measure<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} {}",
            crate::error::number(self.number),
            self.unit.symbol
        )
    }
}

impl<D: Dimension> FromStr for Measure<D> {
    type Err = UnitError;

    fn from_str(text: &str) -> Result<Self, UnitError> {
        let (number, symbol) = split_number(text.trim());
        let number: f64 = number.parse().map_err(|_| not_a_measure::<D>(text))?;
        if symbol.is_empty() {
            return Err(Self::without_unit(crate::error::number(number)));
        }
        let measure = Measure {
            number,
            unit: find_unit::<D>(symbol)?,
            dimension: PhantomData,
        };
        let value = measure.base();
        if !value.is_finite() || value.abs() > LARGEST {
            let text = quoted(text);
            return Err(UnitError(format!("{text} is beyond {LARGEST:e}")));
        }
        Ok(measure)
    }
}

fn not_a_measure<D: Dimension>(text: &str) -> UnitError {
    UnitError(format!(
        "{} is not {}: that is a number and its unit, like \"2.5 {}\"",
        quoted(text),
        D::NAME,
        D::UNITS[0].symbol
    ))
}

fn find_unit<D: Dimension>(symbol: &str) -> Result<&'static Unit, UnitError> {
    let known = |unit: &&Unit| unit.symbol == symbol || unit.spellings.contains(&symbol);
    D::UNITS.iter().find(known).ok_or_else(|| {
        let (name, symbol, units) = (D::NAME, quoted(symbol), Measure::<D>::units());
        UnitError(format!("{symbol} is not a unit of {name} (units: {units})"))
    })
}

/// A text in quotes, with control characters escaped, shortened for a message.
pub(crate) fn quoted(text: &str) -> String {
    let short: String = text.chars().take(60).collect();
    let dots = if short.len() < text.len() { "…" } else { "" };
    format!("\"{}{dots}\"", short.escape_debug())
}

/// Splits "2.5e-3 mm" into the longest decimal number at the start and the trimmed rest.
fn split_number(text: &str) -> (&str, &str) {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        let run = bytes.iter().skip(from);
        from + run.take_while(|b| b.is_ascii_digit()).count()
    };
    let is = |at: usize, set: &[u8]| bytes.get(at).is_some_and(|b| set.contains(b));
    let mut end = digits(usize::from(is(0, b"+-")));
    if is(end, b".") {
        end = digits(end + 1);
    }
    if is(end, b"eE") {
        let exponent = end + 1 + usize::from(is(end + 1, b"+-"));
        let last = digits(exponent);
        // An e without digits after it is not an exponent, but the start of the unit.
        end = if last > exponent { last } else { end };
    }
    let (number, rest) = text.split_at(end);
    (number, rest.trim())
}

/// A unit: its symbol, other spellings of it, and base units per unit as a fraction.
#[derive(Debug, PartialEq)]
pub struct Unit {
    symbol: &'static str,
    spellings: &'static [&'static str],
    times: f64,
    over: f64,
    /// The power of the speed of light (m/s) that turns base units in seconds into ones in metres.
    light: i8,
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

/// A unit with base 1/s, which 1/c converts to 1/m.
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
const ACCELERATIONS: [Unit; 9] = {
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
        // Standard gravity, 9.80665 m/s² (CGPM 1901).
        Unit {
            light: -2,
            ..unit("g", 9.80665, 1.0)
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

/// The kind of quantity of a measure, and its units.
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
    TemperatureDimension,
    Temperature,
    "A temperature (K, mK).",
    "a temperature",
    [unit("K", 1.0, 1.0), unit("mK", 1.0, 1e3)]
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
    "A proper acceleration, as a/c² (/m, /cm, /mm, /km) or a (m/s2, g, c/s, c/ns, c/ps).",
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

#[cfg(test)]
mod tests;
