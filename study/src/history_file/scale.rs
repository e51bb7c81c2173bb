//! Dimension scales and file images: what the safe HDF5 binding has no call for.
//!
//! A dimension scale is a dataset with the attributes `CLASS` and `NAME` (fixed-length,
//! null-terminated text) and `REFERENCE_LIST`; a dataset along it carries `DIMENSION_LIST` ("HDF5
//! Dimension Scale Specification and Design Notes"). The high-level library that writes them is not
//! linked, so they are written by hand here.
#![expect(unsafe_code, reason = "calls into libhdf5; the one room that makes them")]

use std::ffi::CString;

use hdf5::types::VarLenArray;
use hdf5::{Dataset, File, Group, H5Type, Location, ObjectReference, ObjectReference1};
use hdf5_sys::h5a::{H5Aclose, H5Acreate2, H5Awrite};
use hdf5_sys::h5f::H5Fget_file_image;
use hdf5_sys::h5p::H5P_DEFAULT;
use hdf5_sys::h5s::{H5S_class_t, H5Sclose, H5Screate};
use hdf5_sys::h5t::{H5T_C_S1, H5Tclose, H5Tcopy, H5Tset_size};

/// One entry of `REFERENCE_LIST`.
#[derive(Debug, Clone, Copy, H5Type)]
#[repr(C)]
struct Attached {
    dataset: ObjectReference1,
    dimension: i32,
}

/// Makes `scale` the dimension scale of the first axis of `datasets`, all of them in `group`.
pub fn attach(
    group: &Group,
    scale: &Dataset,
    name: &str,
    datasets: &[Dataset],
) -> hdf5::Result<()> {
    fixed_text(scale, "CLASS", "DIMENSION_SCALE")?;
    fixed_text(scale, "NAME", name)?;
    let reference = ObjectReference1::create(group, name)?;
    let mut list = Vec::with_capacity(datasets.len());
    for dataset in datasets {
        let axes = [VarLenArray::from_slice(&[reference])];
        dataset.new_attr_builder().with_data(&axes).create("DIMENSION_LIST")?;
        let path = dataset.name();
        let dataset = ObjectReference1::create(group, &path)?;
        list.push(Attached { dataset, dimension: 0 });
    }
    scale.new_attr_builder().with_data(&list).create("REFERENCE_LIST")?;
    Ok(())
}

/// Writes text of fixed length with its terminating null: the only kind the specification takes for
/// a dimension scale.
fn fixed_text(location: &Location, name: &str, text: &str) -> hdf5::Result<()> {
    let name = CString::new(name).map_err(|error| error.to_string())?;
    let text = CString::new(text).map_err(|error| error.to_string())?;
    let bytes = text.as_bytes_with_nul();
    hdf5::sync::sync(|| {
        // SAFETY: every id comes from the call before it and is checked and closed here; `bytes`
        // is as long as the type says.
        unsafe {
            let kind = H5Tcopy(*H5T_C_S1);
            let space = H5Screate(H5S_class_t::H5S_SCALAR);
            let sized = H5Tset_size(kind, bytes.len());
            let attribute =
                H5Acreate2(location.id(), name.as_ptr(), kind, space, H5P_DEFAULT, H5P_DEFAULT);
            let written = if sized < 0 || attribute < 0 {
                -1
            } else {
                H5Awrite(attribute, kind, bytes.as_ptr().cast())
            };
            if attribute >= 0 {
                H5Aclose(attribute);
            }
            H5Sclose(space);
            H5Tclose(kind);
            if written < 0 { Err("cannot write a fixed text attribute".into()) } else { Ok(()) }
        }
    })
}

/// The bytes of a file held in memory.
pub fn image(file: &File) -> hdf5::Result<Vec<u8>> {
    file.flush()?;
    hdf5::sync::sync(|| {
        // SAFETY: asked with no buffer HDF5 gives the size; the buffer then has that size.
        unsafe {
            let size = H5Fget_file_image(file.id(), std::ptr::null_mut(), 0);
            let mut bytes = vec![0_u8; usize::try_from(size).unwrap_or(0)];
            let copied = H5Fget_file_image(file.id(), bytes.as_mut_ptr().cast(), bytes.len());
            if size <= 0 || copied != size {
                return Err("cannot take the image of a file in memory".into());
            }
            Ok(bytes)
        }
    })
}
