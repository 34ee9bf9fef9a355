// A block is hit, and its pieces are told: Kerf from Rust through kerf.h.
//   rustc -O break.rs -L native=FOLDER_OF_LIBKERF -l kerf && LD_LIBRARY_PATH=FOLDER_OF_LIBKERF ./break
// Handles are freed when their values go; a call that fails gives the library's sentence.
use std::ffi::CStr;
use std::fmt;
use std::os::raw::{c_char, c_void};
use std::ptr::{null, null_mut};

// The part of kerf.h that this program uses.
mod sys {
    use super::*;

    #[repr(C)]
    pub struct Part {
        pub parent: i32,
        pub divided: i32,
        pub whole: i32,
        pub hulls: u32,
        pub volume: f64,
        pub centroid: [f64; 3],
        pub inertia: [f64; 9],
    }

    extern "C" {
        pub fn kerf_last_message() -> *const c_char;
        pub fn kerf_status_name(status: i32) -> *const c_char;
        pub fn kerf_free(handle: *mut c_void) -> i32;
        pub fn kerf_shape_block(size: *const f64, edge: f64, mesh: *mut *mut c_void) -> i32;
        pub fn kerf_solid_create(mesh: *mut c_void, solid: *mut *mut c_void) -> i32;
        pub fn kerf_break(
            solid: *mut c_void, point: *const f64, direction: *const f64, energy: f64, budget_ms: f64,
            options: *const c_void, breaking: *mut *mut c_void, finished: *mut i32,
        ) -> i32;
        pub fn kerf_break_continue(breaking: *mut c_void, budget_ms: f64, finished: *mut i32) -> i32;
        pub fn kerf_breaking_count(breaking: *mut c_void, count: *mut usize) -> i32;
        pub fn kerf_breaking_part(breaking: *mut c_void, index: usize, part: *mut Part) -> i32;
    }
}

// What a call failed with.
#[derive(Debug)]
struct Error(String);

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(&self.0)
    }
}

// A text of the library; it is copied, since a later call may replace it.
fn text(from: *const c_char) -> String {
    unsafe { CStr::from_ptr(from) }.to_string_lossy().into_owned()
}

fn check(status: i32) -> Result<(), Error> {
    if status == 0 {
        return Ok(());
    }
    Err(Error(unsafe { format!("{}: {}", text(sys::kerf_status_name(status)), text(sys::kerf_last_message())) }))
}

// A handle of any kind.
struct Handle(*mut c_void);

impl Handle {
    // Calls with room for a handle.
    fn made(make: impl FnOnce(*mut *mut c_void) -> i32) -> Result<Handle, Error> {
        let mut at = null_mut();
        check(make(&mut at))?;
        Ok(Handle(at))
    }
}

impl Drop for Handle {
    fn drop(&mut self) {
        unsafe { sys::kerf_free(self.0) };
    }
}

fn block(size: [f64; 3], edge: f64) -> Result<Handle, Error> {
    Handle::made(|mesh| unsafe { sys::kerf_shape_block(size.as_ptr(), edge, mesh) })
}

// Breaks a solid by a blow, 4 ms a frame, and returns its pieces and the number of frames.
fn hit(solid: &Handle, point: [f64; 3], direction: [f64; 3], energy: f64) -> Result<(Vec<sys::Part>, u32), Error> {
    let mut finished = 0;
    let mut frames = 1;
    let breaking = Handle::made(|made| unsafe {
        sys::kerf_break(solid.0, point.as_ptr(), direction.as_ptr(), energy, 4.0, null(), made, &mut finished)
    })?;
    while finished == 0 {
        check(unsafe { sys::kerf_break_continue(breaking.0, 4.0, &mut finished) })?;
        frames += 1;
    }
    let mut count = 0;
    check(unsafe { sys::kerf_breaking_count(breaking.0, &mut count) })?;
    let mut pieces = Vec::new();
    for index in 0..count {
        let mut part = std::mem::MaybeUninit::uninit();
        check(unsafe { sys::kerf_breaking_part(breaking.0, index, part.as_mut_ptr()) })?;
        let part = unsafe { part.assume_init() };
        if part.divided == 0 {
            pieces.push(part);
        }
    }
    Ok((pieces, frames))
}

fn run() -> Result<(), Error> {
    let mesh = block([1.0, 1.0, 1.0], 0.125)?;
    let solid = Handle::made(|made| unsafe { sys::kerf_solid_create(mesh.0, made) })?;
    let (pieces, frames) = hit(&solid, [0.2, 0.2, 1.0], [0.0, 0.0, -1.0], 700.0)?;
    println!("{} pieces after {} frames", pieces.len(), frames);
    let mut volume = 0.0;
    for piece in &pieces {
        let [x, y, z] = piece.centroid;
        println!("volume {:.4} at {:.3} {:.3} {:.3}, {} hull", piece.volume, x, y, z, piece.hulls);
        volume += piece.volume;
    }
    assert!((volume - 1.0).abs() < 1e-9 && pieces.len() > 1, "the pieces do not fill the block");
    assert!(pieces.iter().all(|piece| piece.whole == 1 && piece.hulls >= 1 && piece.parent >= 0));
    // A call that fails.
    let error = hit(&mesh, [0.0; 3], [0.0; 3], 1.0).err().expect("a mesh is no solid");
    println!("{}", error);
    Ok(())
}

fn main() {
    if let Err(error) = run() {
        eprintln!("break: {}", error);
        std::process::exit(1);
    }
}
