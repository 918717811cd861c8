//! How far apart two descriptors are (the paper's eq. 8): a dissimilarity, smaller is more alike.
