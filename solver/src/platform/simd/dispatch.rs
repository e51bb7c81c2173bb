//! Which instruction set a kernel runs on, chosen when it is called.

/// Defines `pub fn $name(path, arguments…)` that runs the `#[inline(always)]` function `$kernel` on
/// the instruction set of `path`.
///
/// A path this machine lacks runs as scalar: the bits are the same.
macro_rules! dispatch {
    ($(#[$meta:meta])* $vis:vis fn $name:ident / $kernel:ident ($($arg:ident : $ty:ty),* $(,)?) $(-> $ret:ty)?) => {
        $(#[$meta])*
        #[expect(unsafe_code, reason = "each instruction set is entered only where it is detected")]
        $vis fn $name(path: $crate::platform::simd::InstructionSet, $($arg: $ty),*) $(-> $ret)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn avx2($($arg: $ty),*) $(-> $ret)? {
                    $kernel($($arg),*)
                }
                #[target_feature(enable = "avx512f,avx512dq")]
                fn avx512($($arg: $ty),*) $(-> $ret)? {
                    $kernel($($arg),*)
                }
                use $crate::platform::simd::InstructionSet;
                match path {
                    // SAFETY: the features are there, just asked for.
                    InstructionSet::Avx2 if path.available() => return unsafe { avx2($($arg),*) },
                    // SAFETY: as above.
                    InstructionSet::Avx512 if path.available() => return unsafe { avx512($($arg),*) },
                    _ => {}
                }
            }
            let _ = path;
            $kernel($($arg),*)
        }
    };
}
pub(crate) use dispatch;

/// Defines `pub fn $name(path, arguments…)` as `dispatch!` does, for a kernel that is written over any
/// [`Wide`] and runs on the registers of each instruction set.
macro_rules! dispatch_wide {
    ($(#[$meta:meta])* $vis:vis fn $name:ident / $kernel:ident ($($arg:ident : $ty:ty),* $(,)?) $(-> $ret:ty)?) => {
        $(#[$meta])*
        #[expect(unsafe_code, reason = "each instruction set is entered only where it is detected")]
        $vis fn $name(path: $crate::platform::simd::InstructionSet, $($arg: $ty),*) $(-> $ret)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn avx2($($arg: $ty),*) $(-> $ret)? {
                    $kernel::<$crate::platform::simd::x86::Avx2>($($arg),*)
                }
                #[target_feature(enable = "avx512f,avx512dq")]
                fn avx512($($arg: $ty),*) $(-> $ret)? {
                    $kernel::<$crate::platform::simd::x86::Avx512>($($arg),*)
                }
                use $crate::platform::simd::InstructionSet;
                match path {
                    // SAFETY: the features are there, just asked for.
                    InstructionSet::Avx2 if path.available() => return unsafe { avx2($($arg),*) },
                    // SAFETY: as above.
                    InstructionSet::Avx512 if path.available() => return unsafe { avx512($($arg),*) },
                    _ => {}
                }
            }
            let _ = path;
            $kernel::<$crate::platform::simd::Lanes>($($arg),*)
        }
    };
}
pub(crate) use dispatch_wide;
