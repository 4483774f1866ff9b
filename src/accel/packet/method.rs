//! Options of packet tracing: instructions and precision.

use std::sync::OnceLock;

use serde::{Serialize, Serializer};

#[cfg(target_arch = "x86_64")]
use super::simd::{Avx2, Avx512};
use super::simd::{Portable, Simd, Task};

/// How batches of rays are traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Traversal {
    /// The instruction set to use.
    pub kernel: Kernel,
    /// The precision of results.
    pub precision: Precision,
}

/// An instruction set. Certified results are the same with each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kernel {
    /// AVX-512: packets of 16.
    Avx512,
    /// AVX2 and FMA: packets of 8.
    Avx2,
    /// Any processor: packets of 8, in whatever vectors it has.
    Portable,
    /// Single rays: the reference for the others.
    Scalar,
}

/// The precision of results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// The triangle that exact arithmetic finds, with its numbers in f64.
    Certified,
    /// Everything in f32, for previews: rays along an edge may miss both its triangles, and among triangles at nearly the same depth the
    /// wrong one may be hit. [`Kernel::Scalar`] and incoherent rays are always certified.
    Fast,
}

impl Kernel {
    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Kernel::Avx512 => "avx512",
            Kernel::Avx2 => "avx2",
            Kernel::Portable => "portable",
            Kernel::Scalar => "scalar",
        }
    }
}

impl Precision {
    /// Both, the default first.
    pub const ALL: [Precision; 2] = [Precision::Certified, Precision::Fast];

    /// The name in options, plans and files.
    pub fn name(self) -> &'static str {
        match self {
            Precision::Certified => "certified",
            Precision::Fast => "fast",
        }
    }
}

impl Serialize for Precision {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Default for Traversal {
    /// The best kernel of this processor, certified.
    fn default() -> Traversal {
        Traversal {
            kernel: Kernel::best(),
            precision: Precision::Certified,
        }
    }
}

impl Kernel {
    /// All of them, widest first.
    pub const ALL: [Kernel; 4] = [
        Kernel::Avx512,
        Kernel::Avx2,
        Kernel::Portable,
        Kernel::Scalar,
    ];

    /// Whether this processor has the instructions. A kernel that isn't supported is replaced by
    /// [`Kernel::Portable`].
    pub fn is_supported(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx512 => Avx512::detect().is_some(),
            #[cfg(target_arch = "x86_64")]
            Kernel::Avx2 => Avx2::detect().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            Kernel::Avx512 | Kernel::Avx2 => false,
            Kernel::Portable | Kernel::Scalar => true,
        }
    }

    /// The fastest kernel on this processor, according to measurements of certified primary rays (the benchmark `visibility`), and of
    /// shadow rays where primary rays do not decide.
    ///
    /// | processors | packets of 16 over packets of 8 |
    /// |---|---|
    /// | AMD family 1Ah (Zen 5) | 1.12 to 1.15 times as fast |
    /// | AMD family 19h with AVX-512 (Zen 4) | 1.07 to 1.28 |
    /// | Intel Ice Lake server | 0.88 to 0.95 |
    /// | Intel with AMX (Sapphire Rapids) | 0.98 to 1.08; shadow rays 1.05 to 1.21 |
    ///
    /// Processors that were not measured use packets of 8: most need two steps for 16 lanes, or lower their clock for them.
    pub fn best() -> Kernel {
        let is_fast = |kernel: &Kernel| *kernel != Kernel::Avx512 || has_fast_avx512();
        let mut supported = Kernel::ALL.into_iter().filter(|k| k.is_supported());
        supported.find(is_fast).unwrap_or(Kernel::Portable)
    }

    /// The kernel for single rays. All kernels test eight boxes at a time; AVX-512 sets rays up faster, and has more registers. On AMD's
    /// processors rays then take 0.8 to 0.98 of the time, on Intel's with AMX 1.06 times as long.
    pub(super) fn of_singles(self) -> Kernel {
        match self {
            Kernel::Avx512 if !is_zen_4_or_later() => Kernel::Avx2,
            other => other,
        }
    }

    /// Runs `task` with these instructions.
    pub(super) fn run<T: Task>(self, task: T) -> T::Output {
        #[cfg(target_arch = "x86_64")]
        match self {
            Kernel::Avx512 if let Some(k) = Avx512::detect() => return k.run(task),
            Kernel::Avx2 if let Some(k) = Avx2::detect() => return k.run(task),
            _ => {}
        }
        Portable.run(task)
    }
}

/// Whether packets of 16 are faster than packets of 8 on this processor.
fn has_fast_avx512() -> bool {
    is_zen_4_or_later() || has_amx()
}

/// Whether this is an AMD processor with AVX-512, of family 19h or later.
fn is_zen_4_or_later() -> bool {
    // Evaluated once: in virtual machines the CPUID query takes microseconds.
    static ANSWER: OnceLock<bool> = OnceLock::new();
    *ANSWER.get_or_init(|| {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::x86_64::__cpuid;
            let vendor = __cpuid(0);
            // The letters of "AuthenticAMD", four to a register.
            let is_amd =
                [vendor.ebx, vendor.edx, vendor.ecx] == [0x6874_7541, 0x6974_6e65, 0x444d_4163];
            // The base family, which is 15 here, plus the extended family.
            let signature = __cpuid(1).eax;
            let family = ((signature >> 8) & 0xf) + ((signature >> 20) & 0xff);
            is_amd && family >= 0x19
        }
        #[cfg(not(target_arch = "x86_64"))]
        false
    })
}

/// Whether the processor has AMX, as Intel's do from Sapphire Rapids on. Evaluated once, as above.
fn has_amx() -> bool {
    static ANSWER: OnceLock<bool> = OnceLock::new();
    *ANSWER.get_or_init(|| {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::x86_64::{__cpuid, __cpuid_count};
            // AMX-TILE is bit 24 of EDX.
            __cpuid(0).eax >= 7 && __cpuid_count(7, 0).edx >> 24 & 1 != 0
        }
        #[cfg(not(target_arch = "x86_64"))]
        false
    })
}
