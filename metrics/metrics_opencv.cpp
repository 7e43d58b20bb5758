/* SPDX-License-Identifier: MIT */
/* metrics_opencv.cpp: what is taken from OpenCV. No exception leaves this file. */
#include "metrics/metrics_opencv.h"

#include <opencv2/core.hpp>
#include <opencv2/core/ocl.hpp>
#include <opencv2/quality/qualityssim.hpp>

#include <cstdio>
#include <new>

namespace {

ssfr_result fail(ssfr_result code, const char *text, char *message, size_t size)
{
    std::snprintf(message, size, "OpenCV: %s", text);
    for (char *c = message; *c; c++)
        if (*c == '\n') *c = ' ';
    return code;
}

/* A plane that OpenCV may read but does not own. It has no type for memory that is not written. */
cv::Mat wrap(const double *plane, int w, int h)
{
    return cv::Mat(h, w, CV_64FC1, const_cast<double *>(plane));
}

void compute_ssim(const double *a, const double *b, int w, int h, double *map)
{
    cv::ocl::setUseOpenCL(false); /* the same bits on every machine and run */
    cv::setNumThreads(1);
    cv::Mat quality;
    cv::quality::QualitySSIM::compute(wrap(a, w, h), wrap(b, w, h), quality);
    CV_Assert(quality.type() == CV_64FC1 && quality.rows == h && quality.cols == w);
    quality.copyTo(cv::Mat(h, w, CV_64FC1, map));
}

} // namespace

ssfr_result ssfr_opencv_ssim(const double *a, const double *b, int w, int h, double *map, char *message, size_t size)
{
    try {
        compute_ssim(a, b, w, h, map);
        return SSFR_OK;
    } catch (const cv::Exception &e) {
        return fail(e.code == cv::Error::StsNoMem ? SSFR_ERR_MEMORY : SSFR_ERR_VALUE, e.err.c_str(), message, size);
    } catch (const std::bad_alloc &e) {
        return fail(SSFR_ERR_MEMORY, e.what(), message, size);
    } catch (const std::exception &e) {
        return fail(SSFR_ERR_VALUE, e.what(), message, size);
    } catch (...) {
        return fail(SSFR_ERR_VALUE, "unknown exception", message, size);
    }
}
