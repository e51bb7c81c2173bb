//! Macros that compile one kernel for every instruction set and select one at run time.

/// Defines `fn $name(instruction_set, arguments…)`, which runs the `#[inline(always)]` function
/// `$kernel` compiled for `instruction_set`.
///
/// An instruction set that this machine lacks runs as scalar: the bits are the same.
macro_rules! dispatch {
    ($(#[$meta:meta])* $vis:vis fn $name:ident / $kernel:ident $arguments:tt $(-> $ret:ty)?) => {
        $crate::platform::simd::select! {
            $(#[$meta])* $vis fn $name $arguments $(-> $ret)?;
            [$kernel] [$kernel] [$kernel]
        }
    };
}
pub(crate) use dispatch;

/// Defines `fn $name(instruction_set, arguments…)` as `dispatch!` does, for a kernel that is generic
/// over [`Wide`](super::Wide): each instruction set runs it on its own vector type.
///
/// This macro and the next alone name the types of [`x86`](super::x86): it uses them only inside functions that
/// enable their target feature, entered only after detection. The safety of `x86` rests on that.
macro_rules! dispatch_wide {
    ($(#[$meta:meta])* $vis:vis fn $name:ident / $kernel:ident $arguments:tt $(-> $ret:ty)?) => {
        $crate::platform::simd::select! {
            $(#[$meta])* $vis fn $name $arguments $(-> $ret)?;
            [$kernel::<$crate::platform::simd::x86::Avx2>]
            [$kernel::<$crate::platform::simd::x86::Avx512>]
            [$kernel::<$crate::platform::simd::Lanes>]
        }
    };
}
pub(crate) use dispatch_wide;

/// Defines `fn $name(instruction_set, arguments…)` as `dispatch_wide!` does, for a kernel that also runs on parts of a
/// group: it needs more registers than AVX2 has for whole groups.
macro_rules! dispatch_parts {
    ($(#[$meta:meta])* $vis:vis fn $name:ident / $kernel:ident $arguments:tt $(-> $ret:ty)?) => {
        $crate::platform::simd::select! {
            $(#[$meta])* $vis fn $name $arguments $(-> $ret)?;
            [$kernel::<$crate::platform::simd::x86::Avx2Half>]
            [$kernel::<$crate::platform::simd::x86::Avx512>]
            [$kernel::<$crate::platform::simd::Lanes>]
        }
    };
}
pub(crate) use dispatch_parts;

/// What these macros share: the kernels of AVX2, AVX-512 and scalar code, each compiled with its target feature.
macro_rules! select {
    (
        $(#[$meta:meta])* $vis:vis fn $name:ident ($($arg:ident : $ty:ty),* $(,)?) $(-> $ret:ty)?;
        [$($avx2:tt)+] [$($avx512:tt)+] [$($scalar:tt)+]
    ) => {
        $(#[$meta])*
        #[expect(unsafe_code, reason = "calls a function compiled for a detected instruction set")]
        $vis fn $name(
            instruction_set: $crate::platform::simd::InstructionSet,
            $($arg: $ty),*
        ) $(-> $ret)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn avx2($($arg: $ty),*) $(-> $ret)? {
                    $crate::platform::simd::x86::align_frame();
                    $($avx2)+($($arg),*)
                }
                #[target_feature(enable = "avx512f,avx512dq")]
                fn avx512($($arg: $ty),*) $(-> $ret)? {
                    $crate::platform::simd::x86::align_frame();
                    $($avx512)+($($arg),*)
                }
                use $crate::platform::simd::InstructionSet;
                match instruction_set {
                    InstructionSet::Avx2 if instruction_set.available() => {
                        // SAFETY: `available` has detected avx2, the only feature `avx2` enables.
                        return unsafe { avx2($($arg),*) };
                    }
                    InstructionSet::Avx512 if instruction_set.available() => {
                        // SAFETY: `available` has detected avx512f and avx512dq, the features `avx512`
                        // enables.
                        return unsafe { avx512($($arg),*) };
                    }
                    _ => {}
                }
            }
            let _ = instruction_set;
            $($scalar)+($($arg),*)
        }
    };
}
pub(crate) use select;
