//! Tables in Parquet, in a program without it: all are refused.

use std::convert::Infallible;
use std::fs::File;
use std::io::{self, Write};
use std::marker::PhantomData;

use crate::output::format::TableFormat;
use crate::output::table::{Heading, Series, Table};

/// A file in progress, which does not exist.
pub struct ParquetWriter<W: Write + Send>(Infallible, PhantomData<W>);

fn refused<T>() -> io::Result<T> {
    TableFormat::Parquet.check().map_err(io::Error::other).map(|()| unreachable!("this program has no Parquet"))
}

impl<W: Write + Send> ParquetWriter<W> {
    /// Refuses to begin.
    ///
    /// # Errors
    /// Always.
    pub fn new(_: W, _: &[String], _: &[Heading]) -> io::Result<ParquetWriter<W>> {
        refused()
    }

    /// Appends rows to no file.
    ///
    /// # Errors
    /// None: there is no file.
    pub fn push(&mut self, _: Table) -> io::Result<()> {
        match self.0 {}
    }

    /// Ends no file.
    ///
    /// # Errors
    /// None: there is no file.
    pub fn finish(self) -> io::Result<W> {
        match self.0 {}
    }
}

/// Refuses to make a file.
///
/// # Errors
/// Always.
pub fn file(_: &[String], _: &[Heading], _: Table) -> io::Result<Vec<u8>> {
    refused()
}

/// A file, which does not exist.
pub(super) struct Groups {
    never: Infallible,
    pub(super) headings: Vec<Heading>,
}

impl Groups {
    pub(super) fn new(_: File) -> io::Result<Groups> {
        refused()
    }

    pub(super) fn study(&self) -> Vec<String> {
        match self.never {}
    }

    pub(super) fn count(&self) -> usize {
        match self.never {}
    }

    pub(super) fn group(&self, _: usize, _: &[bool]) -> io::Result<GroupReader> {
        match self.never {}
    }
}

/// Columns of no group.
pub(super) struct GroupReader(Infallible);

impl GroupReader {
    pub(super) fn next(&mut self, _: usize) -> io::Result<Option<(usize, Vec<Series>)>> {
        match self.0 {}
    }
}
