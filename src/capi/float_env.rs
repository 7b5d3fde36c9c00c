//! The floating-point mode: the predicates' error bounds and exact stages hold for round-to-nearest with
//! denormals only, while hosts such as CGAL change the rounding and others flush denormals to zero or unmask
//! exceptions. So the mode is saved and set on entry, the host's own one holds while a callback runs, and the
//! saved one, sticky exception flags included, is put back on exit.
//!
//! x86-64 keeps the mode of SSE arithmetic in MXCSR (the x87 control word does not matter: nothing here uses
//! x87), aarch64 in FPCR and its flags in FPSR. Other targets are left as they are: their hosts must call with
//! round-to-nearest.

use std::cell::Cell;

pub(super) use arch::Mode;

#[cfg(target_arch = "x86_64")]
mod arch {
    use std::arch::asm;

    /// The whole of MXCSR.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Mode(pub u32);

    impl Mode {
        /// All exceptions masked, no flags, to nearest, no FTZ, no DAZ: what the compiler assumes.
        pub const DEFAULT: Mode = Mode(0x1F80);

        pub fn get() -> Mode {
            let mut word = 0u32;
            // SAFETY: stores the 32 bits of MXCSR in `word` and touches nothing else.
            unsafe { asm!("stmxcsr [{}]", in(reg) &mut word, options(nostack, preserves_flags)) };
            Mode(word)
        }

        pub fn set(self) {
            let word = self.0;
            // SAFETY: `word` is `DEFAULT` or came out of MXCSR, so no reserved bit is set. Only the default mode
            // holds while Rust code computes; another one holds between the last computation and the return
            // to the host, or around a call of the host's own code.
            unsafe { asm!("ldmxcsr [{}]", in(reg) &word, options(nostack, preserves_flags)) };
        }
    }
}

#[cfg(target_arch = "aarch64")]
mod arch {
    use std::arch::asm;

    /// FPCR and FPSR.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Mode(pub u64, pub u64);

    impl Mode {
        /// No traps, to nearest, no flushing, no flags: what the compiler assumes.
        pub const DEFAULT: Mode = Mode(0, 0);

        pub fn get() -> Mode {
            let (control, flags): (u64, u64);
            // SAFETY: reads two registers that every process may read.
            unsafe {
                asm!("mrs {}, fpcr", "mrs {}, fpsr", out(reg) control, out(reg) flags, options(nomem, nostack));
            }
            Mode(control, flags)
        }

        pub fn set(self) {
            // SAFETY: writes what is `DEFAULT` or was read from the same registers. Only the default mode holds
            // while Rust code computes; see the other target.
            unsafe { asm!("msr fpcr, {}", "msr fpsr, {}", in(reg) self.0, in(reg) self.1, options(nostack)) };
        }
    }
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
mod arch {
    /// Unknown, and left alone.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Mode;

    impl Mode {
        pub const DEFAULT: Mode = Mode;

        pub fn get() -> Mode {
            Mode
        }

        pub fn set(self) {}
    }
}

thread_local! {
    /// The mode of the host whose call this thread is in.
    static HOST: Cell<Option<Mode>> = const { Cell::new(None) };
}

/// The default mode until it is dropped; then the mode that was found.
pub(super) struct Computing {
    host: Mode,
    outer: Option<Mode>,
}

impl Computing {
    pub fn enter() -> Computing {
        let host = Mode::get();
        Mode::DEFAULT.set();
        let outer = HOST.try_with(|slot| slot.replace(Some(host))).ok().flatten();
        Computing { host, outer }
    }
}

impl Drop for Computing {
    fn drop(&mut self) {
        let _ = HOST.try_with(|slot| slot.set(self.outer));
        self.host.set();
    }
}

/// Runs the host's code in the host's mode, and sets the default one again whatever that code has left.
pub(super) fn in_host_mode<T>(callback: impl FnOnce() -> T) -> T {
    struct Back;
    impl Drop for Back {
        fn drop(&mut self) {
            Mode::DEFAULT.set();
        }
    }
    let _back = Back;
    if let Ok(Some(host)) = HOST.try_with(Cell::get) {
        host.set();
    }
    callback()
}

#[cfg(test)]
pub(super) mod testing {
    //! Host modes that tests put on.

    use super::Mode;

    /// Every mode that a host may be in: the rounding directions, flushing, unmasked exceptions, set flags.
    #[cfg(target_arch = "x86_64")]
    pub fn host_modes() -> Vec<(&'static str, Mode)> {
        vec![
            ("nearest", Mode(0x1F80)),
            ("down", Mode(0x1F80 | 0x2000)),
            ("up", Mode(0x1F80 | 0x4000)),
            ("toward zero", Mode(0x1F80 | 0x6000)),
            ("flush to zero", Mode(0x1F80 | 0x8000)),
            ("denormals are zero", Mode(0x1F80 | 0x0040)),
            ("up, both flushed", Mode(0x1F80 | 0x4000 | 0x8040)),
            ("division by zero and invalid unmasked", Mode(0x1F80 & !0x0280)),
            ("flags set", Mode(0x1F80 | 0x003F)),
        ]
    }

    #[cfg(target_arch = "aarch64")]
    pub fn host_modes() -> Vec<(&'static str, Mode)> {
        vec![
            ("nearest", Mode(0, 0)),
            ("up", Mode(1 << 22, 0)),
            ("down", Mode(2 << 22, 0)),
            ("toward zero", Mode(3 << 22, 0)),
            ("flush to zero", Mode(1 << 24, 0)),
            ("flags set", Mode(0, 0x1F)),
        ]
    }

    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    pub fn host_modes() -> Vec<(&'static str, Mode)> {
        Vec::new()
    }

    /// Runs `call` as a host in `mode` would and gives back its answer and the mode that it left.
    #[inline(never)]
    pub fn as_host<T>(mode: Mode, call: impl FnOnce() -> T) -> (T, Mode) {
        mode.set();
        let answer = call();
        let left = Mode::get();
        Mode::DEFAULT.set();
        (answer, left)
    }
}

#[cfg(test)]
mod tests {
    use std::hint::black_box;

    use super::testing::{as_host, host_modes};
    use super::*;

    #[test]
    fn the_modes_of_the_test_do_change_arithmetic() {
        // Otherwise the tests below would pass whatever `set` did.
        let third = |mode: Mode| as_host(mode, || black_box(1.0f64) / black_box(3.0)).0;
        let by_name = |name: &str| host_modes().into_iter().find(|m| m.0 == name).map(|m| third(m.1));
        if let (Some(down), Some(up)) = (by_name("down"), by_name("up")) {
            assert!(down < up, "{down} {up}");
        }
    }

    #[test]
    fn computing_is_in_default_mode_and_leaves_the_hosts() {
        for (name, mode) in host_modes() {
            let (inside, left) = as_host(mode, || {
                let _computing = Computing::enter();
                let inside = Mode::get();
                // Raises the inexact flag, which the host must not see.
                black_box(black_box(1.0f64) / black_box(3.0));
                inside
            });
            assert_eq!(inside, Mode::DEFAULT, "{name}");
            assert_eq!(left, mode, "{name}");
        }
    }

    #[test]
    fn callbacks_see_the_hosts_mode_and_may_change_it() {
        for (name, mode) in host_modes() {
            for (other_name, other) in host_modes() {
                let ((seen, after), left) = as_host(mode, || {
                    let _computing = Computing::enter();
                    let seen = in_host_mode(|| {
                        let seen = Mode::get();
                        other.set();
                        seen
                    });
                    (seen, Mode::get())
                });
                assert_eq!(seen, mode, "{name}");
                assert_eq!(after, Mode::DEFAULT, "{name}, then {other_name}");
                assert_eq!(left, mode, "{name}, then {other_name}");
            }
        }
    }

    #[test]
    fn a_call_within_a_callback_nests() {
        for (name, mode) in host_modes() {
            let (seen, left) = as_host(mode, || {
                let _computing = Computing::enter();
                in_host_mode(|| drop(Computing::enter()));
                in_host_mode(Mode::get)
            });
            assert_eq!((seen, left), (mode, mode), "{name}");
        }
    }

    #[test]
    fn the_mode_comes_back_after_a_panic() {
        for (name, mode) in host_modes() {
            let (_, left) = as_host(mode, || {
                std::panic::catch_unwind(|| {
                    let _computing = Computing::enter();
                    std::panic::resume_unwind(Box::new(()));
                })
            });
            assert_eq!(left, mode, "{name}");
        }
    }
}
