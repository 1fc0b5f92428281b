// OpenCV's image reader initialises GDAL, which takes two of its own locks in both orders.
#if defined(__SANITIZE_THREAD__)
extern "C" const char* __tsan_default_suppressions() {
  return "deadlock:libgdal.so\n";
}
#endif
