//! A time step allocates nothing, once every buffer has its size: bodies that move on make them grow now and then.

use lbm_ibm::coupling::{Guard, Scene};
use lbm_ibm_benches::scenes::{crowd, on_threads, slit};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The system's allocator, with a count of what it is asked for.
struct Counting;

static CALLS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is handed to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        CALLS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `GlobalAlloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `GlobalAlloc`.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        CALLS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `GlobalAlloc`.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations in 10 steps: the least of three rounds, after one to warm up.
fn allocations(scene: &mut Scene) -> usize {
    let mut round = || {
        let before = CALLS.load(Ordering::Relaxed);
        (0..10).for_each(|_| scene.step().expect("a scene that runs"));
        CALLS.load(Ordering::Relaxed) - before
    };
    round();
    (0..3).map(|_| round()).min().unwrap_or(usize::MAX)
}

/// One test, so that nothing else runs beside it.
#[test]
fn a_step_allocates_nothing_on_one_thread() {
    on_threads(1, || {
        // The guard looks every 1000 steps: it may allocate.
        let rare = || Guard {
            every: 1000,
            ..Guard::default()
        };
        assert_eq!(allocations(&mut slit()?.with_guard(rare())), 0, "a cell in a slit");
        assert_eq!(
            allocations(&mut crowd(24, 2)?.with_guard(rare())),
            0,
            "a crowd of spheres"
        );
        Ok(())
    })
    .expect("scenes that can be built");
}
