# find_package(OpenCVStereo): the modules of OpenCV 4 that the tests compare with, as the target
# OpenCVStereo::OpenCVStereo. Debian has OpenCV's own package configuration only together with all of
# its modules, their libraries for video and display included.
find_path(OpenCVStereo_INCLUDE_DIR opencv2/calib3d.hpp PATH_SUFFIXES opencv4)
set(OpenCVStereo_libraries "")
foreach(module calib3d imgproc core)
  find_library(OpenCVStereo_${module}_LIBRARY opencv_${module})
  mark_as_advanced(OpenCVStereo_${module}_LIBRARY)
  list(APPEND OpenCVStereo_libraries ${OpenCVStereo_${module}_LIBRARY})
endforeach()
mark_as_advanced(OpenCVStereo_INCLUDE_DIR)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenCVStereo REQUIRED_VARS OpenCVStereo_INCLUDE_DIR
  OpenCVStereo_calib3d_LIBRARY OpenCVStereo_imgproc_LIBRARY OpenCVStereo_core_LIBRARY)

if(OpenCVStereo_FOUND AND NOT TARGET OpenCVStereo::OpenCVStereo)
  add_library(OpenCVStereo::OpenCVStereo INTERFACE IMPORTED)
  target_include_directories(OpenCVStereo::OpenCVStereo SYSTEM INTERFACE
    ${OpenCVStereo_INCLUDE_DIR})
  target_link_libraries(OpenCVStereo::OpenCVStereo INTERFACE ${OpenCVStereo_libraries})
endif()
