//! The built-in lightmap, which is packed more tightly than an npz can be, so that the crate stays small.
//!
//! Samples of f16 from a Monte Carlo simulation hardly compress as they stand. But the pulse of the lamp spans several
//! bins, so that the light of a texel is smooth in time, and texels side by side see much the same light. So each sample is
//! predicted as a weighted sum of those already known: the eight bins before it, and bins around it of the texels to the
//! left, above and aside. Weights for four ranges of brightness were fitted to the array by least squares. Sums are of
//! integers (samples count 2⁻²⁴, the step of subnormal f16; weights count 2⁻¹⁶), so that they are the same on every machine.
//!
//! What is stored is the difference between the bits of sample and prediction, in an adaptive binary arithmetic code:
//! its magnitude in steps of about the size of the differences nearby, first the number of whole steps in unary, then the
//! rest from the highest bit, then the sign. Chances adapt to what came before, for each size of the differences nearby, and those of
//! signs also for the signs of the differences nearby: those of one texel resemble their predecessors.
//! Before all that a texel says whether it repeats the one to its left, or the one above: those around charts do, and dark ones.
//! Unpacking it gives the bits of `scenes/corner/lightmap.npz`.
//!
//! Sources: linear prediction and contexts by nearby differences, Weinberger, Seroussi, Sapiro, "The LOCO-I lossless image
//! compression algorithm", IEEE Trans. Image Processing 9 (2000); arithmetic coding, Witten, Neal, Cleary, "Arithmetic
//! coding for data compression", Comm. ACM 30 (1987).

use std::io::{self, Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Rows, columns, time bins, channels.
const SHAPE: [usize; 4] = [242, 66, 153, 1];
const PACKED: &[u8] = include_bytes!("../../scenes/corner/lightmap.packed");

/// The samples that a prediction sums: how many rows, columns and bins before the sample (negative: after it).
const NEIGHBOURS: [[isize; 3]; 26] = [
    [0, 0, 1],
    [0, 0, 2],
    [0, 0, 3],
    [0, 0, 4],
    [0, 0, 5],
    [0, 0, 6],
    [0, 0, 7],
    [0, 0, 8], // the same texel
    [0, 1, -1],
    [0, 1, 0],
    [0, 1, 1],
    [0, 1, 2],
    [0, 1, 3], // to its left
    [1, 0, -1],
    [1, 0, 0],
    [1, 0, 1],
    [1, 0, 2],
    [1, 0, 3], // above
    [1, 1, 0],
    [1, 1, 1],
    [1, -1, 0],
    [1, -1, 1], // above to the left and to the right
    [0, 2, 0],
    [0, 2, 1],
    [2, 0, 0],
    [2, 0, 1], // two to the left, two above
];
/// Those of the neighbours whose largest decides on the weights: the bin before, to the left, above.
const NEAREST: [usize; 3] = [0, 9, 14];
/// Least brightness of each row of weights but the first, in 2⁻²⁴.
const RANGES: [i32; 3] = [1 << 10, 1 << 13, 1 << 16];
/// Weights of the neighbours, in 2⁻¹⁶.
#[rustfmt::skip]
const WEIGHTS: [[i32; 26]; 4] = [
    [236_250, -374_611, 339_175, -194_661, 75_298, -19_532, 3131, -231, 4151, 4693, -16_408, 11_253, -2647, -5, 9779, -17_880, 10_874, -2177, -4637, 3689, 2523, -2291, -1199, 1042, 5, -3],
    [235_573, -388_797, 383_237, -248_822, 111_049, -33_301, 6037, -477, 7528, -10_542, 5770, -1438, -295, 1680, 53, -3887, 3844, -1091, -2907, 2142, 2717, -2512, -541, 504, -79, 103],
    [218_402, -347_159, 338_906, -219_018, 93_289, -22_536, 947, 708, 14_257, -25_298, 24_399, -13_579, 2683, 606, 4908, -6398, 3598, -1140, -5500, 3477, 1456, -1152, -1424, 1154, -87, 58],
    [242_457, -443_554, 512_999, -395_026, 187_607, -31_647, -19_187, 10_183, 23_176, -52_824, 55_608, -32_057, 8324, 14, 498, -1106, 1278, -579, -514, 328, 63, -126, -705, 851, 144, -101],
];

/// Zeros before rows, before and after columns and bins, as far as the neighbours reach, so that all of them exist.
const BEFORE: [usize; 3] = [2, 2, 8];
const AFTER: [usize; 3] = [0, 1, 1];

/// The lightmap as an npz file with the array `radiance`.
pub(super) fn lightmap() -> io::Result<Vec<u8>> {
    let samples = code(&mut Decoder::of(PACKED), None);
    Ok(archive(&npy(&samples))?)
}

/// Codes all samples, in C order: those of `known` if they are, those that the decoder finds if not. Returns them as the
/// bytes of little-endian f16.
fn code(coder: &mut impl Coder, known: Option<&[u16]>) -> Vec<u8> {
    let [rows, columns, bins, _] = SHAPE;
    let stride = [columns + BEFORE[1] + AFTER[1], bins + BEFORE[2] + AFTER[2]];
    let index = |r: usize, c: usize, k: usize| (r * stride[0] + c) * stride[1] + k;
    let back = |[r, c, k]: [isize; 3]| (r * stride[0] as isize + c) * stride[1] as isize + k;
    let neighbours = NEIGHBOURS.map(back);

    // Samples in 2⁻²⁴ and how far each was from its prediction, with the zeros around them.
    let size = (rows + BEFORE[0] + AFTER[0]) * stride[0] * stride[1];
    let mut values = vec![0i32; size];
    let mut missed = vec![0i16; size];
    let mut chances = vec![Chances::default(); CONTEXTS];
    let mut samples = Vec::with_capacity(2 * rows * columns * bins);

    // Which neighbour a texel repeats: neither, the left one, the one above; and the chances of each by what those two repeat.
    let mut repeats = vec![0; rows * columns];
    let mut repeating = [[[Chance::EVEN; 2]; 3]; 3];
    for texel in 0..rows * columns {
        let [row, column] = [texel / columns, texel % columns];
        let first = index(row + BEFORE[0], column + BEFORE[1], BEFORE[2]);

        // Outside of the array texels are dark.
        let of = |texel: Option<usize>| texel.map_or(0, |texel: usize| repeats[texel]);
        let chances_here = &mut repeating[of(texel.checked_sub(1))][of(texel.checked_sub(columns))];
        let sources = [[0, 1, 0], [1, 0, 0]].map(|beside| first.wrapping_add_signed(-back(beside)));
        let is_repeated = |known: &[u16], source: usize| {
            let known = known[texel * bins..][..bins]
                .iter()
                .map(|bits| value(*bits));
            known.eq(values[source..][..bins].iter().copied())
        };
        let source = (0..2).find(|&k| {
            let is = known.is_some_and(|known| is_repeated(known, sources[k]));
            chances_here[k].code(coder, is)
        });
        if let Some(k) = source {
            repeats[texel] = k + 1;
            values.copy_within(sources[k]..sources[k] + bins, first);
            missed.copy_within(sources[k]..sources[k] + bins, first);
            let row = values[first..][..bins].iter();
            samples.extend(row.flat_map(|value| bits(i64::from(*value)).to_le_bytes()));
            continue;
        }

        for bin in 0..bins {
            // The prediction, rounded to f16.
            let here = first + bin;
            let near = neighbours.map(|back| values[here.wrapping_add_signed(-back)]);
            let brightness = NEAREST.map(|i| near[i]).into_iter().fold(0, i32::max);
            let weights = &WEIGHTS[RANGES.iter().filter(|least| brightness >= **least).count()];
            let sum: i64 = (weights.iter().zip(near))
                .map(|(w, v)| i64::from(*w) * i64::from(v))
                .sum();
            let predicted = i32::from(bits((sum + (1 << 15)) >> 16));

            // Differences nearby: the nearest three count twice.
            let missed_by = |r, c, k| missed[here.wrapping_add_signed(-back([r, c, k]))];
            let miss = |r, c, k| u32::from(missed_by(r, c, k).unsigned_abs());
            let spread = 2 * (miss(0, 0, 1) + miss(0, 1, 0) + miss(1, 0, 0))
                + miss(0, 0, 2)
                + miss(0, 1, -1)
                + miss(0, 2, 0)
                + miss(1, 0, -1)
                + miss(1, 1, 0)
                + miss(1, -1, 0)
                + miss(2, 0, 0);

            let known = known.map(|known| i32::from(known[texel * bins + bin]) - predicted);
            // Signs of the three bins before and of the texel above, as digits to the base of three.
            let signs = [
                missed_by(0, 0, 1),
                missed_by(0, 0, 2),
                missed_by(0, 0, 3),
                missed_by(1, 0, 0),
            ];
            let signs =
                (signs.into_iter()).fold(0, |all, miss| 3 * all + (miss.signum() + 1) as usize);
            let difference = chances[context(spread)].code(coder, (step(spread), signs), known);
            let sample = (predicted + difference) as u16;
            values[here] = value(sample);
            missed[here] = difference as i16;
            samples.extend(sample.to_le_bytes());
        }
    }
    samples
}

/// The value of an f16 that is not negative, in 2⁻²⁴.
fn value(bits: u16) -> i32 {
    match bits >> 10 {
        0 => i32::from(bits),
        exponent => i32::from(bits & 0x3FF | 0x400) << (exponent - 1),
    }
}

/// The bits of the f16 next to a value in 2⁻²⁴; of zero if that is negative.
fn bits(value: i64) -> u16 {
    let value = value.clamp(0, i64::from(i32::MAX)) as u64;
    // A subnormal number is its own bits.
    let Some(shift) = value.checked_ilog2().and_then(|log| log.checked_sub(10)) else {
        return value as u16;
    };
    // Rounding up to the next power of two carries into the exponent, as it should.
    let rounded = (value + ((1 << shift) >> 1)) >> shift;
    (((shift as u64 + 1) << 10) + rounded - 0x400) as u16
}

const CONTEXTS: usize = 64;
/// Four signs, each of which is negative, zero or positive.
const SIGNS: usize = 81;

/// Which chances belong to a sum of differences nearby: four for each doubling.
fn context(spread: u32) -> usize {
    let spread = spread + 4;
    let log = spread.ilog2();
    ((4 * (log - 2) + ((spread >> (log - 2)) & 3)) as usize).min(CONTEXTS - 1)
}

/// Log₂ of the step in which a magnitude is counted, about a quarter of the mean difference nearby.
fn step(spread: u32) -> u32 {
    ((spread + 1) / 26).checked_ilog2().unwrap_or(0)
}

/// The longest count of steps; a difference beyond it follows in full.
const MOST_STEPS: usize = 40;
/// Bits of a difference in full.
const FULL: u32 = 16;

/// The chances of the bits of a difference.
#[derive(Clone)]
struct Chances {
    goes_on: [Chance; MOST_STEPS],
    /// The two highest bits below the step, for each of the first counts of steps.
    below: [[Chance; 2]; 8],
    /// For each combination of signs nearby.
    negative: [Chance; SIGNS],
}

impl Default for Chances {
    fn default() -> Self {
        Self {
            goes_on: [Chance::EVEN; MOST_STEPS],
            below: [[Chance::EVEN; 2]; 8],
            negative: [Chance::EVEN; SIGNS],
        }
    }
}

impl Chances {
    /// Codes a difference, `known` or from the decoder, whose magnitude is counted in steps of 2^`step`, near differences with these
    /// `signs`.
    fn code(
        &mut self,
        coder: &mut impl Coder,
        (step, signs): (u32, usize),
        known: Option<i32>,
    ) -> i32 {
        let magnitude = known.map_or(0, i32::unsigned_abs);

        let mut steps = 0;
        while steps < MOST_STEPS
            && self.goes_on[steps].code(coder, magnitude >> step > steps as u32)
        {
            steps += 1;
        }
        let (mut coded, low) = if steps == MOST_STEPS {
            (0, FULL)
        } else {
            (steps as u32, step)
        };
        for place in (0..low).rev() {
            let bit = magnitude >> place & 1 == 1;
            let bit = match (low - 1 - place) as usize {
                place @ (0 | 1) => self.below[steps.min(7)][place].code(coder, bit),
                _ => coder.code(1 << 15, bit),
            };
            coded = coded << 1 | u32::from(bit);
        }

        if coded > 0 && self.negative[signs].code(coder, known.is_some_and(|known| known < 0)) {
            -(coded as i32)
        } else {
            coded as i32
        }
    }
}

/// The chance that a bit is one, in 2⁻¹⁶: the mean of one that follows the latest bits and one that follows many.
#[derive(Clone, Copy)]
struct Chance {
    soon: u16,
    late: u16,
}

impl Chance {
    const EVEN: Self = Self {
        soon: 1 << 15,
        late: 1 << 15,
    };

    fn code(&mut self, coder: &mut impl Coder, bit: bool) -> bool {
        let chance = (u32::from(self.soon) + u32::from(self.late)) / 2;
        // Neither bit may be impossible.
        let bit = coder.code(chance.clamp(32, (1 << 16) - 32), bit);
        for (chance, rate) in [(&mut self.soon, 5), (&mut self.late, 8)] {
            match bit {
                true => *chance += (u16::MAX - *chance) >> rate,
                false => *chance -= *chance >> rate,
            }
        }
        bit
    }
}

/// An encoder or a decoder.
trait Coder {
    /// Codes a bit which is one with `chance` · 2⁻¹⁶: writes it, or ignores it and returns the one that it reads.
    fn code(&mut self, chance: u32, bit: bool) -> bool;
}

/// The interval of an arithmetic code: all 32-bit numbers from `low` to `high`.
struct Interval {
    low: u32,
    high: u32,
}

impl Interval {
    const ALL: Self = Self {
        low: 0,
        high: u32::MAX,
    };

    /// The last number that means one.
    fn middle(&self, chance: u32) -> u32 {
        let range = u64::from(self.high - self.low);
        self.low + ((range * u64::from(chance)) >> 16) as u32
    }

    /// Keeps the part that means `bit`.
    fn narrow(&mut self, middle: u32, bit: bool) {
        match bit {
            true => self.high = middle,
            false => self.low = middle + 1,
        }
    }

    /// Drops the highest byte if it is settled.
    fn shift(&mut self) -> Option<u8> {
        if (self.low ^ self.high) >> 24 != 0 {
            return None;
        }
        let settled = (self.high >> 24) as u8;
        self.low <<= 8;
        self.high = self.high << 8 | 0xFF;
        Some(settled)
    }
}

struct Decoder<'a> {
    interval: Interval,
    number: u32,
    bytes: std::slice::Iter<'a, u8>,
}

impl<'a> Decoder<'a> {
    fn of(bytes: &'a [u8]) -> Self {
        let mut decoder = Self {
            interval: Interval::ALL,
            number: 0,
            bytes: bytes.iter(),
        };
        (0..4).for_each(|_| decoder.read());
        decoder
    }

    /// The next byte of the number; zeros after the last.
    fn read(&mut self) {
        self.number = self.number << 8 | u32::from(self.bytes.next().copied().unwrap_or(0));
    }
}

impl Coder for Decoder<'_> {
    fn code(&mut self, chance: u32, _: bool) -> bool {
        let middle = self.interval.middle(chance);
        let bit = self.number <= middle;
        self.interval.narrow(middle, bit);
        while self.interval.shift().is_some() {
            self.read();
        }
        bit
    }
}

/// `samples` with the header of an npy file, version 1.0.
fn npy(samples: &[u8]) -> Vec<u8> {
    let shape = SHAPE.map(|n| n.to_string()).join(", ");
    let header = format!("{{'descr': '<f2', 'fortran_order': False, 'shape': ({shape}), }}");
    // Magic, version, length of the header, and the header itself fill a multiple of 64 bytes.
    let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((length as u16).to_le_bytes());
    file.extend(format!("{header:<width$}\n", width = length - 1).bytes());
    file.extend(samples);
    file
}

fn archive(npy: &[u8]) -> zip::result::ZipResult<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::with_capacity(npy.len() + 512)));
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    archive.start_file("radiance.npy", stored)?;
    archive.write_all(npy)?;
    Ok(archive.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    struct Encoder {
        interval: Interval,
        bytes: Vec<u8>,
    }

    impl Coder for Encoder {
        fn code(&mut self, chance: u32, bit: bool) -> bool {
            let middle = self.interval.middle(chance);
            self.interval.narrow(middle, bit);
            while let Some(byte) = self.interval.shift() {
                self.bytes.push(byte);
            }
            bit
        }
    }

    /// The array of the npz, as an npy file.
    fn original() -> Vec<u8> {
        let file = std::fs::File::open("scenes/corner/lightmap.npz").unwrap();
        let mut archive = zip::ZipArchive::new(file).unwrap();
        let mut npy = Vec::new();
        let mut member = archive.by_name("radiance.npy").unwrap();
        member.read_to_end(&mut npy).unwrap();
        npy
    }

    #[test]
    fn the_packed_lightmap_has_the_bits_of_the_npz() {
        assert!(npy(&code(&mut Decoder::of(PACKED), None)) == original());
    }

    #[test]
    fn packing_the_npz_gives_the_packed_lightmap() {
        let original = original();
        let length = 2 * SHAPE.iter().product::<usize>();
        let samples = original[original.len() - length..].chunks_exact(2);
        let samples: Vec<u16> = samples.map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
        let mut encoder = Encoder {
            interval: Interval::ALL,
            bytes: Vec::new(),
        };
        code(&mut encoder, Some(&samples));
        // One byte more settles the last bits, as the decoder reads zeros after it.
        encoder.bytes.push((encoder.interval.high >> 24) as u8);
        assert!(encoder.bytes == PACKED, "{} bytes", encoder.bytes.len());
    }
}
