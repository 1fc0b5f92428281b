// OpenCV's picture reader registers GDAL, whose start-up takes its own two locks in both orders.
#if defined(__SANITIZE_THREAD__)
extern "C" const char* __tsan_default_suppressions() {
  return "deadlock:libgdal.so\n";
}
#endif
