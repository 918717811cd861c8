//! Where models come from: files, folders, archives, standard input.
